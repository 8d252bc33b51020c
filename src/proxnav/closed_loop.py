"""The closed loop: render what the camera sees, estimate the pose, filter it, tell the estimator where to look next."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.flight.truth import Truth
from proxnav.frames import FrameConfig, FrameJob, Renderer
from proxnav.geometry import Camera
from proxnav.geometry.types import Box
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.events import Event, events
from proxnav.navigation.navigator import Navigator, scene_of
from proxnav.navigation.prediction import predict_view
from proxnav.records import KeypointData, Keypoints, PoseData, PoseResult, SensorRecords, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.sensor.presets import SPEED_CLASS
from proxnav.trajectories.assemble import assemble


@dataclass(frozen=True)
class ClosedLoopConfig:
    """What stands between truth and filter."""

    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    rate_hz: float = 1.0
    """Frames per second of flight."""
    latency_s: float = 0.5
    """From the exposure to the pose."""
    renderer: Renderer = "raycast"
    seed: int = 0
    """Of the images' noise."""
    threads: int = 0
    """Of the network; 0 takes all cores."""


@dataclass(frozen=True, slots=True, eq=False)
class _Reading:
    """What the estimator found in one frame."""

    t: float
    keypoints: Keypoints
    result: PoseResult


def frame_times(truth: Truth, config: ClosedLoopConfig) -> np.ndarray:
    """Indices of the truth at which the camera takes a frame."""
    if not config.rate_hz > 0.0:
        raise InputError(f"the camera's rate must be positive, found {config.rate_hz:g} Hz")
    return np.arange(0, len(truth), max(1, round(1.0 / (config.rate_hz * truth.step_s))))


def closed_loop(
    truth: Truth,
    records: SensorRecords,
    camera: Camera,
    navigation: NavigationConfig,
    config: ClosedLoopConfig,
    done: Callable[[], None] = lambda: None,
) -> SensorRecords:
    """The records of the other sensors completed by what the estimator read, frame by frame, guided by the filter.

    The filter has at each exposure only what has arrived by then. InputError where no frame shows the target.
    """
    estimator = PoseEstimator.load(config.model, threads=config.threads)
    scene = scene_of(records, estimator.points_target_m, camera, navigation)
    stream, k = events(records, scene), frame_times(truth, config)
    navigator, draw = Navigator(scene, float(truth.t[0])), FrameJob(estimator.target, FrameConfig(config.renderer))()
    flight, look = _flight(truth, k), SceneConfig(sensor=SPEED_CLASS, sequence="closed loop")
    waiting: list[Event] = []
    found: list[_Reading] = []
    for i, t in enumerate(flight.t.tolist()):
        while stream and stream[0].received <= t:
            navigator.put(stream.pop(0))
        while waiting and waiting[0].received <= t:
            navigator.put(waiting.pop(0))
        image = draw(
            scene_at(flight, i, index=i, target=estimator.target, camera=camera, config=look, seed=config.seed)
        )
        keypoints, result = estimator.observe(image.image, camera, _expected(navigator, t, estimator, camera))
        if result.T_cam_target is not None and result.covariance is not None:
            found.append(_Reading(t, keypoints, result))
            waiting.extend(_events(found[-1], config.latency_s, navigation))
        done()
    if not found:
        raise InputError(
            f"none of {len(flight)} frames showed the target to {config.model}: choose a sunlit piece with --start-s"
        )
    return replace(records, keypoints=_keypoints(found, config), poses=_poses(found, config))


def _flight(truth: Truth, k: np.ndarray) -> Trajectory:
    """The truth at the frames, with the Sun."""
    return assemble(
        truth.epoch_utc, truth.t[k], (truth.r_eci_target_m[k], truth.v_eci_target_mps[k]),
        (truth.r_eci_chaser_m[k], truth.v_eci_chaser_mps[k]), q_eci_target=truth.q_eci_target[k],
        q_eci_cam=truth.q_eci_cam[k], source="closed loop",
    )  # fmt: skip


def _expected(navigator: Navigator, t: float, estimator: PoseEstimator, camera: Camera) -> Box | None:
    """The box in which the filter expects the target; None while it does not know."""
    state = navigator.at(t)
    if state is None or state.status not in ("tracking", "coasting"):
        return None
    box = predict_view(state, estimator.points_target_m, camera).box_xyxy
    return box if np.isfinite(box).all() and (box[2:] - box[:2]).min() > 1.0 else None


def _events(reading: _Reading, latency_s: float, navigation: NavigationConfig) -> list[Event]:
    pose, cov = reading.result.T_cam_target, reading.result.covariance
    assert pose is not None
    received = reading.t + latency_s
    out = [Event(reading.t, received, "poses", (pose.q_wxyz, pose.t_m, cov))]
    if navigation.coupling == "tight":
        values = (reading.keypoints.pixels, reading.keypoints.covariances_px2)
        out.append(Event(reading.t, received, "keypoints", values))
    return out


def _keypoints(found: list[_Reading], config: ClosedLoopConfig) -> KeypointData:
    t = np.array([reading.t for reading in found])
    pixels = np.array([reading.keypoints.pixels for reading in found])
    return KeypointData(
        t, t + config.latency_s, pixels, np.array([reading.keypoints.covariances_px2 for reading in found])
    )


def _poses(found: list[_Reading], config: ClosedLoopConfig) -> PoseData:
    t = np.array([reading.t for reading in found])
    poses = [reading.result.T_cam_target for reading in found]
    return PoseData(
        t, t + config.latency_s, np.array([pose.q_wxyz for pose in poses if pose is not None]),
        np.array([pose.t_m for pose in poses if pose is not None]),
        np.array([reading.result.covariance for reading in found]),
    )  # fmt: skip
