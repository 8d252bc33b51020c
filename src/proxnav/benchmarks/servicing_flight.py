"""A servicer that approaches and circles a target, flown, guided and controlled by Basilisk's own modules.

What it knows of the target comes through one message of a relative navigation; who writes it is the caller's choice.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from proxnav.benchmarks.basilisk_orbits import earth_with_j2
from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, MU_EARTH, R_eci_lvlh
from proxnav.geometry.pointing import q_a_cam_looking
from proxnav.geometry.relative_motion import eci_from_ric
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records.scene import Triple

EPOCH = "2026-03-20T12:00:00Z"
"""The Sun stands along +x of ECI, and so does the normal of the orbit below: no eclipse, light from the side."""
ALTITUDE_M = 550e3
STEP_S, CONTROL_S, FRAME_S = 0.5, 1.0, 2.0
MASS_KG, INERTIA = 24.0, (0.5, 0.6, 0.6)
_TARGET_MASS_KG = 4900.0
_BANDWIDTH = 0.1
"""Bandwidth of the position loop [rad/s]: accelerations of the path, for which the control has no input, cost 0.1 m."""
_ATTITUDE_BANDWIDTH = 0.15
CAMERA_AT = (0.10, 0.0, 0.05)
"""Camera on the body [m]."""
Q_BODY_CAM = np.array([0.5, -0.5, 0.5, -0.5])
"""The camera looks along +x of the body, its y is -z of the body."""


@dataclass(frozen=True)
class ServicingPath:
    """Where the servicer is wanted: along a line from far to near, then once round at that range, then hold."""

    far_m: float = 100.0
    near_m: float = 12.0
    hold_s: float = 60.0
    """Before the approach; the flight ends with holding, too."""
    approach_s: float = 640.0
    round_s: float = 1000.0
    elevation_deg: float = 37.0
    """Angle of the line above the orbit's plane, towards the Sun: the lit side is seen all the way round."""

    def at(self, t: float) -> tuple[Vector3, Vector3]:
        """(position [m], its rate [m/s]) in the Hill frame of the target."""
        s, s_dot = _smooth((t - self.hold_s) / self.approach_s, self.approach_s)
        a, a_dot = _smooth((t - self.hold_s - self.approach_s) / self.round_s, self.round_s)
        rho, rho_dot = self.far_m + s * (self.near_m - self.far_m), s_dot * (self.near_m - self.far_m)
        angle, rate, up = 2.0 * np.pi * a, 2.0 * np.pi * a_dot, np.deg2rad(self.elevation_deg)
        c, d = np.cos(up), np.sin(up)
        line = np.array([c * np.sin(angle), -c * np.cos(angle), d])
        turn = np.array([c * np.cos(angle), c * np.sin(angle), 0.0])
        return rho * line, rho_dot * line + rho * rate * turn


@dataclass(frozen=True)
class ServicedTarget:
    """How the target moves."""

    inertia: Triple = (1000.0, 3000.0, 3200.0)
    """Principal moments along its axes [kg m^2]."""
    tumble_deg_s: Triple | None = None
    """Rates about its axes; None: held, fixed in LVLH."""


@dataclass(frozen=True, slots=True)
class ServicingFlight:
    """The simulation with what a navigation is to be wired to."""

    sim: Any
    """SimBaseClass with the tasks flight, camera, navigation and control; control waits to be enabled."""
    target: Any
    """`spacecraft.Spacecraft` of the target."""
    chaser: Any
    own: Any
    """`simpleNav` of the chaser."""
    pointing: Any
    """`locationPointing`: wants the target's NavTransMsg in `scTargetInMsg`."""
    control: Any
    """`hillFrameRelativeControl`: wants `hillStateInMsg` and `chiefTransInMsg`."""
    kept: tuple[Any, ...]
    """What must live as long as the simulation."""


def servicing_flight(
    path: ServicingPath, serviced: ServicedTarget, offset_m: Triple = (0.0, 0.0, 0.0)
) -> ServicingFlight:
    """Both craft at the start of the path, the servicer `offset_m` beside it (Hill axes) and looking at the target.

    InputError where Basilisk is not installed.
    """
    try:
        from Basilisk.architecture import bskLogging  # pyright: ignore[reportMissingImports]
        from Basilisk.utilities import SimulationBaseClass, macros  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise InputError("flights by another simulator need Basilisk: pip install 'proxnav[basilisk]'") from error
    bskLogging.setDefaultLogLevel(bskLogging.BSK_WARNING)
    sim = SimulationBaseClass.SimBaseClass()
    process = sim.CreateNewProcess("process")
    tasks = (("flight", STEP_S), ("camera", FRAME_S), ("navigation", CONTROL_S), ("control", CONTROL_S))
    for priority, (name, step) in zip((40, 30, 20, 10), tasks, strict=True):
        process.addTask(sim.CreateNewTask(name, macros.sec2nano(step)), priority)
    target, chaser, earth = *_craft(path, serviced, offset_m), earth_with_j2()
    from Basilisk.simulation import extForceTorque, simpleNav, spacecraft  # pyright: ignore[reportMissingImports]

    thrusters, own = extForceTorque.ExtForceTorque(), simpleNav.SimpleNav()
    for craft in (target, chaser):
        craft.gravField.gravBodies = spacecraft.GravBodyVector([earth])
        sim.AddModelToTask("flight", craft)
    chaser.addDynamicEffector(thrusters)
    own.scStateInMsg.subscribeTo(chaser.scStateOutMsg)
    for model in (thrusters, own):
        sim.AddModelToTask("flight", model)
    pointing, control, kept = _controllers(sim, own, thrusters, path)
    sim.disableTask("control")
    return ServicingFlight(sim, target, chaser, own, pointing, control, (earth, thrusters, *kept))


def _craft(path: ServicingPath, serviced: ServicedTarget, offset_m: Triple) -> tuple[Any, Any]:
    radius = EARTH_EQUATORIAL_RADIUS + ALTITUDE_M
    speed = float(np.sqrt(MU_EARTH / radius))
    r, v, rate = np.array([0.0, radius, 0.0]), np.array([0.0, 0.0, speed]), speed / radius
    rho, rho_dot = path.at(0.0)
    r_chaser, v_chaser = eci_from_ric(r, v, rho + np.array(offset_m), rho_dot)
    rates = np.array([0.0, -rate, 0.0]) if serviced.tumble_deg_s is None else np.deg2rad(serviced.tumble_deg_s)
    held = quaternion.from_matrix(R_eci_lvlh(r, v))
    look = q_a_cam_looking(r - r_chaser, np.array([1.0, 0.0, 0.0]), v)
    body = quaternion.multiply(look, quaternion.conjugate(Q_BODY_CAM))
    turning = quaternion.rotate(quaternion.conjugate(body), np.array([rate, 0.0, 0.0]))
    target = _spacecraft("target", _TARGET_MASS_KG, serviced.inertia, (r, v), (held, rates))
    return target, _spacecraft("servicer", MASS_KG, INERTIA, (r_chaser, v_chaser), (body, turning))


def _spacecraft(
    name: str, mass_kg: float, inertia: Triple, place: tuple[Vector3, Vector3], attitude: tuple[QuatWxyz, Vector3]
) -> Any:
    from Basilisk.simulation import spacecraft  # pyright: ignore[reportMissingImports]
    from Basilisk.utilities import RigidBodyKinematics  # pyright: ignore[reportMissingImports]

    craft = spacecraft.Spacecraft()
    craft.ModelTag = name
    craft.hub.mHub, craft.hub.IHubPntBc_B = mass_kg, np.diag(inertia).tolist()
    craft.hub.r_CN_NInit, craft.hub.v_CN_NInit = place[0].tolist(), place[1].tolist()
    craft.hub.sigma_BNInit = RigidBodyKinematics.EP2MRP(quaternion.canonical(attitude[0])).tolist()
    craft.hub.omega_BN_BInit = attitude[1].tolist()
    return craft


def _controllers(sim: Any, own: Any, thrusters: Any, path: ServicingPath) -> tuple[Any, Any, tuple[Any, ...]]:
    """(pointing, position control, what must live on), all in the task control."""
    from Basilisk.architecture import messaging, sysModel  # pyright: ignore[reportMissingImports]
    from Basilisk.fswAlgorithms import (  # pyright: ignore[reportMissingImports]
        hillFrameRelativeControl,
        locationPointing,
        mrpFeedback,
    )

    body = messaging.VehicleConfigMsgPayload()
    body.massSC, body.ISCPntB_B = MASS_KG, np.diag(INERTIA).ravel().tolist()
    vehicle = messaging.VehicleConfigMsg().write(body)
    pointing = locationPointing.locationPointing()
    pointing.pHat_B = [1.0, 0.0, 0.0]
    pointing.useBoresightRateDamping = 1
    pointing.scAttInMsg.subscribeTo(own.attOutMsg)
    pointing.scTransInMsg.subscribeTo(own.transOutMsg)
    turning = mrpFeedback.mrpFeedback()
    turning.K, turning.P = 4.0 * max(INERTIA) * _ATTITUDE_BANDWIDTH**2, 2.0 * max(INERTIA) * _ATTITUDE_BANDWIDTH
    turning.Ki = -1.0
    turning.guidInMsg.subscribeTo(pointing.attGuidOutMsg)
    turning.vehConfigInMsg.subscribeTo(vehicle)
    control = hillFrameRelativeControl.HillFrameRelativeControl()
    control.setMu(MU_EARTH)
    control.setK((_BANDWIDTH**2 * np.eye(3)).ravel().tolist())
    control.setP((2.0 * _BANDWIDTH * np.eye(3)).ravel().tolist())
    control.deputyVehicleConfigInMsg.subscribeTo(vehicle)

    class Guidance(sysModel.SysModel):
        """Tells the control where the path is."""

        def UpdateState(self, nanos: int) -> None:
            place, rate = path.at(1e-9 * nanos)
            control.setReferencePosition(place.tolist())
            control.setReferenceVelocity(rate.tolist())

    guidance = Guidance()
    thrusters.cmdTorqueInMsg.subscribeTo(turning.cmdTorqueOutMsg)
    thrusters.cmdForceInertialInMsg.subscribeTo(control.forceOutMsg)
    for model in (guidance, pointing, turning, control):
        sim.AddModelToTask("control", model)
    return pointing, control, (vehicle, turning, guidance)


def _smooth(share: float, seconds: float) -> tuple[float, float]:
    """(0 to 1 with speed zero at both ends, its rate [1/s])."""
    s = min(max(share, 0.0), 1.0)
    return s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s) / seconds
