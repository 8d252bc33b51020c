"""Two craft flown by Basilisk (AVSLab, ISC licence): another simulator's gravity, air and rigid bodies."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, EARTH_J2, MU_EARTH
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records.scene import Triple

_STEP_S = 0.1
"""Step of Basilisk's own fourth-order Runge-Kutta integration."""
_SCALE_HEIGHT_M = 60e3
_MASS_KG, _AREA_M2, _DRAG = (4900.0, 24.0), (8.0, 0.06), 2.2
"""Mass and area are those of target and chaser."""


@dataclass(frozen=True)
class RigidBody:
    """First state of one craft, ECI axes; its body axes are principal."""

    r_eci_m: Vector3
    v_eci_mps: Vector3
    q_eci_body: QuatWxyz
    rate: Vector3
    """Body axes [rad/s]."""
    inertia: Triple
    """Principal moments [kg m^2]."""


@dataclass(frozen=True, slots=True, eq=False)
class Flown:
    """States of one craft at regular instants."""

    t: Float[np.ndarray, "n"]
    r_eci_m: Float[np.ndarray, "n 3"]
    """Centre of mass."""
    v_eci_mps: Float[np.ndarray, "n 3"]
    q_eci_body: Float[np.ndarray, "n wxyz=4"]
    rate: Float[np.ndarray, "n 3"]
    """Body axes [rad/s]."""


def fly_pair(
    target: RigidBody, chaser: RigidBody, seconds: float, sample_s: float, density_kg_m3: float, altitude_m: float
) -> tuple[Flown, Flown]:
    """Both craft under Earth's gravity with J2 and drag; the air has that density at that altitude.

    InputError where Basilisk is not installed.
    """
    try:
        from Basilisk.architecture import bskLogging  # pyright: ignore[reportMissingImports]
        from Basilisk.simulation import exponentialAtmosphere  # pyright: ignore[reportMissingImports]
        from Basilisk.utilities import SimulationBaseClass, macros  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise InputError("flights by another simulator need Basilisk: pip install 'proxnav[basilisk]'") from error
    bskLogging.setDefaultLogLevel(bskLogging.BSK_WARNING)
    sim = SimulationBaseClass.SimBaseClass()
    sim.CreateNewProcess("process").addTask(sim.CreateNewTask("flight", macros.sec2nano(_STEP_S)))
    air = exponentialAtmosphere.ExponentialAtmosphere()
    air.planetRadius, air.scaleHeight = EARTH_EQUATORIAL_RADIUS, _SCALE_HEIGHT_M
    air.baseDensity, air.envMinReach, air.envMaxReach = density_kg_m3 * np.exp(altitude_m / _SCALE_HEIGHT_M), -1, -1
    sim.AddModelToTask("flight", air)
    kept = [_added(sim, air, body, k, sample_s) for k, body in enumerate((target, chaser))]
    sim.InitializeSimulation()
    sim.ConfigureStopTime(macros.sec2nano(seconds))
    sim.ExecuteSimulation()
    first, second = (_recorded(recorder) for recorder, *_ in kept)
    return first, second


def _added(sim: Any, air: Any, body: RigidBody, k: int, sample_s: float) -> tuple[Any, ...]:
    """(recorder, what must live as long as the simulation) of one craft."""
    from Basilisk.simulation import dragDynamicEffector, spacecraft  # pyright: ignore[reportMissingImports]
    from Basilisk.utilities import RigidBodyKinematics, macros  # pyright: ignore[reportMissingImports]

    craft, drag, earth = spacecraft.Spacecraft(), dragDynamicEffector.DragDynamicEffector(), earth_with_j2()
    craft.hub.mHub, craft.hub.IHubPntBc_B = _MASS_KG[k], np.diag(body.inertia).tolist()
    craft.hub.r_CN_NInit, craft.hub.v_CN_NInit = body.r_eci_m.tolist(), body.v_eci_mps.tolist()
    craft.hub.sigma_BNInit = RigidBodyKinematics.EP2MRP(body.q_eci_body).tolist()
    craft.hub.omega_BN_BInit = body.rate.tolist()
    craft.gravField.gravBodies = spacecraft.GravBodyVector([earth])
    drag.coreParams.projectedArea, drag.coreParams.dragCoeff = _AREA_M2[k], _DRAG
    air.addSpacecraftToModel(craft.scStateOutMsg)
    drag.atmoDensInMsg.subscribeTo(air.envOutMsgs[k])
    craft.addDynamicEffector(drag)
    recorder = craft.scStateOutMsg.recorder(macros.sec2nano(sample_s))
    for model in (craft, drag, recorder):
        sim.AddModelToTask("flight", model)
    return recorder, craft, drag, earth


def earth_with_j2() -> Any:
    """Earth with J2 by hand: the files of Basilisk's own fields come over the network."""
    from Basilisk.simulation import gravityEffector  # pyright: ignore[reportMissingImports]

    earth, field = gravityEffector.GravBodyData(), gravityEffector.SphericalHarmonicsGravityModel()
    field.maxDeg, field.muBody, field.radEquator = 2, MU_EARTH, EARTH_EQUATORIAL_RADIUS
    field.cBar = [[1.0], [0.0, 0.0], [-EARTH_J2 / np.sqrt(5.0), 0.0, 0.0]]
    field.sBar = [[0.0], [0.0, 0.0], [0.0, 0.0, 0.0]]
    earth.planetName = earth.displayName = "earth"
    earth.mu, earth.radEquator, earth.isCentralBody, earth.gravityModel = MU_EARTH, EARTH_EQUATORIAL_RADIUS, True, field
    return earth


def _recorded(recorder: Any) -> Flown:
    from Basilisk.utilities import RigidBodyKinematics  # pyright: ignore[reportMissingImports]

    q = np.array([RigidBodyKinematics.MRP2EP(sigma) for sigma in np.array(recorder.sigma_BN)])
    return Flown(
        1e-9 * np.array(recorder.times(), dtype=np.float64), np.array(recorder.r_CN_N), np.array(recorder.v_CN_N),
        quaternion.normalize(q), np.array(recorder.omega_BN_B),
    )  # fmt: skip
