"""The servicing flight closed through our camera, estimator and filter, and what it came to."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from proxnav.benchmarks.servicing_flight import (
    CAMERA_AT,
    EPOCH,
    FRAME_S,
    Q_BODY_CAM,
    ServicedTarget,
    ServicingFlight,
    ServicingPath,
    servicing_flight,
)
from proxnav.errors import InputError
from proxnav.evaluation.navigation_errors import NavErrors
from proxnav.flight.truth import Truth
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.relative_motion import ric_from_eci
from proxnav.navigation.config import CraftGeometry, FilterNoise, NavigationConfig
from proxnav.records.scene import Triple
from proxnav.storage.run_record import run_record
from proxnav.targets.loading import load_target

_GEOMETRY = CraftGeometry(
    target_centre_sigma_m=0.02, chaser_centre_sigma_m=0.0, misalignment_sigma_deg=0.0, clock_sigma_s=0.0
)
_NOISE = FilterNoise(acceleration=1e-6, accelerometer=1e-5)
"""Basilisk's simpleNav tells burns without noise."""
_LONGEST_WAIT_S = 60.0
_END_S = 60.0
"""End of the last hold, over which the end position is judged."""


@dataclass(frozen=True)
class LoopConfig:
    """One closed-loop flight."""

    poses: Literal["estimated", "true"] = "estimated"
    """Poses of our estimator in rendered images, or the true ones in their place."""
    path: ServicingPath = field(default_factory=ServicingPath)
    serviced: ServicedTarget = field(default_factory=ServicedTarget)
    seconds: float = 1800.0
    size_px: int = 1024
    """Side of the square image; the field of view is 40 deg."""
    offset_m: Triple = (0.3, -0.5, 0.2)
    """Start beside the path, Hill axes."""
    seed: int = 0
    model: str = "space-rider"
    threads: int = 0
    """Threads of the network; 0 takes all cores."""


@dataclass(frozen=True, slots=True, eq=False)
class LoopRun:
    """A flown loop."""

    truth: Truth
    errors: NavErrors
    summary: dict[str, Any]


def fly_loop(config: LoopConfig, out: Path, done: Callable[[], None] = lambda: None) -> LoopRun:
    """Flies, writes the run folder and returns errors and summary; `done` is called once a frame.

    InputError where Basilisk is not installed or no pose is found in the first minute.
    """
    flight = servicing_flight(config.path, config.serviced, config.offset_m)
    from Basilisk.utilities import macros  # pyright: ignore[reportMissingImports]

    from proxnav.live.basilisk.camera_config import mounting_of
    from proxnav.live.basilisk.recorded_run import Recorders, recorded_truth, write_run

    camera = loop_camera(config.size_px)
    parts = _wired(flight, config, camera)
    rate = macros.sec2nano(1.0)
    messages = (flight.chaser.scStateOutMsg, flight.target.scStateOutMsg, flight.own.attOutMsg, flight.own.transOutMsg)
    recorders = Recorders(*(message.recorder(rate) for message in messages))
    for recorder in (recorders.chaser, recorders.target, recorders.attitude, recorders.orbit):
        flight.sim.AddModelToTask("flight", recorder)
    began = time.perf_counter()
    _run(flight, parts, config.seconds, done)
    wall = time.perf_counter() - began
    mounting = mounting_of(parts.camera_config.read())
    truth = recorded_truth(recorders, mounting, EPOCH)
    errors = write_run(out, truth, recorders, parts.poses.fixes, parts.navigation.states, camera, mounting)
    off = _off_path_m(recorders, config.path)
    return LoopRun(truth, errors, run_record(config) | _summary(truth, errors, parts, off) | {"wall_s": wall})


def loop_camera(size_px: int) -> Camera:
    """The servicer's camera: 40 deg from edge to edge."""
    f = 1407.0 / 1024.0 * size_px
    return Camera(width=size_px, height=size_px, fx=f, fy=f, cx=0.5 * size_px, cy=0.5 * size_px)


@dataclass(frozen=True, slots=True)
class _Parts:
    """What stands between the two craft."""

    camera_config: Any
    poses: Any
    navigation: Any
    camera: Any | None
    """None where the poses are true."""


def _wired(flight: ServicingFlight, config: LoopConfig, camera: Camera) -> _Parts:
    from Basilisk.architecture import messaging  # pyright: ignore[reportMissingImports]

    from proxnav.live.basilisk import PoseSensor, RelativeNavigation, RenderedCamera, TruePoseSensor
    from proxnav.live.basilisk.camera_config import config_payload

    message = messaging.CameraConfigMsg().write(config_payload(camera, np.array(CAMERA_AT), Q_BODY_CAM))
    drawn: RenderedCamera | None = None
    if config.poses == "true":
        poses = TruePoseSensor()
        poses.chaserStateInMsg.subscribeTo(flight.chaser.scStateOutMsg)
        poses.targetStateInMsg.subscribeTo(flight.target.scStateOutMsg)
    else:
        from proxnav.estimator import PoseEstimator

        drawn = RenderedCamera("space-rider", epoch_utc=EPOCH, seed=config.seed)
        drawn.chaserStateInMsg.subscribeTo(flight.chaser.scStateOutMsg)
        drawn.targetStateInMsg.subscribeTo(flight.target.scStateOutMsg)
        drawn.cameraConfigInMsg.subscribeTo(message)
        flight.sim.AddModelToTask("camera", drawn, 20)
        poses = PoseSensor(PoseEstimator.load(config.model, threads=config.threads))
        poses.imageInMsg.subscribeTo(drawn.imageOutMsg)
        poses.chaserAttInMsg.subscribeTo(flight.own.attOutMsg)
    poses.cameraConfigInMsg.subscribeTo(message)
    navigation = RelativeNavigation(poses, load_target("space-rider").keypoints_m, filter_of(config.serviced))
    if isinstance(poses, PoseSensor):
        poses.expected = navigation.expected
    navigation.chaserAttInMsg.subscribeTo(flight.own.attOutMsg)
    navigation.chaserTransInMsg.subscribeTo(flight.own.transOutMsg)
    navigation.cameraConfigInMsg.subscribeTo(message)
    flight.sim.AddModelToTask("camera", poses, 10)
    flight.sim.AddModelToTask("navigation", navigation)
    flight.pointing.scTargetInMsg.subscribeTo(navigation.targetTransOutMsg)
    flight.control.chiefTransInMsg.subscribeTo(navigation.targetTransOutMsg)
    flight.control.hillStateInMsg.subscribeTo(navigation.hillStateOutMsg)
    return _Parts(message, poses, navigation, drawn)


def filter_of(serviced: ServicedTarget) -> NavigationConfig:
    """The filter for a target that is held, or that tumbles with moments that are known to 5 %."""
    if serviced.tumble_deg_s is None:
        return NavigationConfig(noise=_NOISE, geometry=_GEOMETRY)
    return NavigationConfig(target="free", inertia=serviced.inertia, noise=_NOISE, geometry=_GEOMETRY)


def _run(flight: ServicingFlight, parts: _Parts, seconds: float, done: Callable[[], None]) -> None:
    """Control begins with the first state of the filter."""
    from Basilisk.utilities import macros  # pyright: ignore[reportMissingImports]

    flight.sim.InitializeSimulation()
    enabled = False
    for t in np.arange(0.0, seconds + 0.5 * FRAME_S, FRAME_S).tolist():
        flight.sim.ConfigureStopTime(macros.sec2nano(t))
        flight.sim.ExecuteSimulation()
        if not enabled and parts.navigation.status == "tracking":
            flight.sim.enableTask("control")
            enabled = True
        if not enabled and t > _LONGEST_WAIT_S:
            raise InputError(
                f"no pose in the first {_LONGEST_WAIT_S:g} s of the flight: is the target lit and in view?"
            )
        done()


def _off_path_m(recorders: Any, path: ServicingPath) -> Float[np.ndarray, "n"]:
    """Distance of the servicer's body from where it is wanted [m]."""
    chaser, target = recorders.chaser, recorders.target
    orbits = (target.r_BN_N, target.v_BN_N, chaser.r_BN_N, chaser.v_BN_N)
    rho, _ = ric_from_eci(*(np.array(column) for column in orbits))
    wanted = np.array([path.at(1e-9 * float(nanos))[0] for nanos in chaser.times()])
    return np.linalg.norm(rho - wanted, axis=1)


def _summary(truth: Truth, errors: NavErrors, parts: _Parts, off: Float[np.ndarray, "n"]) -> dict[str, Any]:
    seconds = {"filter": parts.navigation.seconds}
    frames = len(parts.poses.fixes)
    if parts.camera is not None:
        frames = parts.camera.frames
        seconds |= {"drawing": parts.camera.seconds, "estimating": parts.poses.seconds}
    position, last = np.linalg.norm(errors.errors[:, :3], axis=1), truth.t >= truth.t[-1] - _END_S
    near, ended = errors.range_m < 20.0, errors.t >= errors.t[-1] - _END_S
    turned = np.rad2deg(np.linalg.norm(errors.errors[:, 6:9], axis=1))
    return {
        "frames": frames, "poses": len(parts.poses.fixes), "seconds_of_flight": float(truth.t[-1]),
        "seconds_in": seconds, "end_off_path_m": float(off[-1]), "mean_end_off_path_m": float(off[last].mean()),
        "worst_off_path_m_within_20_m": _worst(off[np.linalg.norm(truth.relative[0], axis=1) < 20.0]),
        "nearest_surface_m": nearest_surface_m(truth), "rms_position_m": _rms(position),
        "rms_position_m_within_20_m": _rms(position[near]), "rms_position_m_at_the_end": _rms(position[ended]),
        "rms_attitude_deg_within_20_m": _rms(turned[near]), "mean_nees": float(np.nanmean(errors.nees)),
        "inside_3_sigma": float(np.nanmean(errors.inside_3_sigma)), "status": parts.navigation.status,
        "delta_v_mps": _delta_v(parts),
    }  # fmt: skip


def nearest_surface_m(truth: Truth) -> float:
    """Least distance [m] between the camera and a vertex of the target's mesh, over the whole flight."""
    vertices = load_target("space-rider").vertices_m
    back = quaternion.conjugate(truth.q_eci_target)
    eyes = quaternion.rotate(back, truth.r_eci_chaser_m - truth.r_eci_target_m)
    return float(min(np.linalg.norm(vertices - eye, axis=1).min() for eye in eyes))


def _delta_v(parts: _Parts) -> float:
    return float(parts.navigation.gained_mps)


def _rms(values: np.ndarray) -> float | None:
    return float(np.sqrt(np.mean(values**2))) if len(values) else None


def _worst(values: np.ndarray) -> float | None:
    return float(values.max()) if len(values) else None
