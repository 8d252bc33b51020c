"""The closed loop: render what the camera sees, estimate the pose, filter it, tell the estimator where to look next."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int, Shaped

from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.flight.truth import Truth
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Camera
from proxnav.geometry.calibration import N_CALIBRATION
from proxnav.geometry.types import Box
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.navigator import Navigator
from proxnav.navigation.predicted_measurement import predict_measurement
from proxnav.navigation.readings import KeypointFrame, PoseFix, Reading
from proxnav.navigation.stream import readings
from proxnav.records import KeypointData, PoseData, SensorRecords, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.sensor.presets import SPEED_CLASS
from proxnav.trajectories.assemble import assemble

LATENCY_S = 0.5
"""From the exposure to the pose: network, pose solver and alignment on a small computer."""


@dataclass(frozen=True)
class ClosedLoopConfig:
    """What stands between truth and filter."""

    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    rate_hz: float = 1.0
    """Frames per second of flight."""
    seed: int = 0
    """Seed of the images' noise."""
    threads: int = 0
    """Threads of the network; 0 takes all cores."""


@dataclass(frozen=True, slots=True, eq=False)
class _Found:
    """What the estimator read in one frame."""

    keypoints: KeypointFrame
    pose: PoseFix


def frame_times(truth: Truth, config: ClosedLoopConfig) -> Int[np.ndarray, "n_frames"]:
    """Indices of the truth at which the camera takes a frame."""
    if not config.rate_hz > 0.0:
        raise InputError(f"the camera's rate must be positive, found {config.rate_hz:g} Hz")
    return truth.every(config.rate_hz)


def closed_loop(
    truth: Truth,
    records: SensorRecords,
    camera: Camera,
    navigation: NavigationConfig,
    config: ClosedLoopConfig,
    done: Callable[[], None] = lambda: None,
) -> SensorRecords:
    """The records of the other sensors completed by what the estimator read, frame by frame, guided by the filter.

    Frames are those of a camera that differs from the given one by what is not known of it.

    The filter has at each exposure only what has arrived by then. InputError where no frame shows the target.
    """
    estimator = PoseEstimator.load(config.model, threads=config.threads)
    setup, k = setup_of(records, estimator.points_target_m, camera, navigation), frame_times(truth, config)
    draw = FrameJob(estimator.target, FrameConfig("raycast"))()
    navigator, stream = Navigator(setup, float(truth.t[0])), readings(records, setup)
    flight, look = flown(truth, k), SceneConfig(sensor=SPEED_CLASS, sequence="closed loop")
    seen_by = camera.erring(np.random.default_rng(config.seed).normal(size=N_CALIBRATION))
    waiting: list[Reading] = []
    found: list[_Found] = []
    for i, t in enumerate(flight.t.tolist()):
        _hand_over(stream, navigator, t)
        _hand_over(waiting, navigator, t)
        scene = scene_at(flight, i, index=i, target=estimator.target, camera=seen_by, config=look, seed=config.seed)
        image, box = draw(scene).image, _expected(navigator, t, estimator, camera)
        frame = _read(estimator, image, camera, box, t)
        if frame is not None:
            found.append(frame)
            waiting.append(frame.pose)
            if navigation.coupling == "tight":
                waiting.append(frame.keypoints)
        done()
    if not found:
        raise InputError(
            f"none of {len(flight)} frames showed the target to {config.model}: choose a sunlit piece with --start-s"
        )
    return replace(records, keypoints=_keypoints(found), poses=_poses(found))


def _hand_over(readings: list[Reading], navigator: Navigator, t: float) -> None:
    """The filter gets what has arrived by `t`."""
    while readings and readings[0].received <= t:
        navigator.put(readings.pop(0))


def _read(
    estimator: PoseEstimator, image: Shaped[np.ndarray, "h w"], camera: Camera, box: Box | None, t: float
) -> _Found | None:
    """Keypoints and pose of one frame; None where the estimator has no pose."""
    keypoints, result = estimator.keypoints_and_pose(image, camera, box)
    pose = result.T_cam_target
    if pose is None or result.covariance is None:
        return None
    received = t + LATENCY_S
    return _Found(
        KeypointFrame(t, received, keypoints.pixels, keypoints.covariances_px2),
        PoseFix(t, received, pose.q_wxyz, pose.t_m, result.covariance),
    )


def flown(truth: Truth, k: Int[np.ndarray, "n_frames"]) -> Trajectory:
    """The truth at instants `k`, with the Sun: what scenes are made along."""
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
    return predict_measurement(state, estimator.points_target_m, camera).box_xyxy


def _keypoints(found: list[_Found]) -> KeypointData:
    frames = [frame.keypoints for frame in found]
    return KeypointData(
        np.array([frame.t for frame in frames]), np.array([frame.received for frame in frames]),
        np.array([frame.pixels for frame in frames]), np.array([frame.covariances_px2 for frame in frames]),
    )  # fmt: skip


def _poses(found: list[_Found]) -> PoseData:
    poses = [frame.pose for frame in found]
    return PoseData(
        np.array([pose.t for pose in poses]), np.array([pose.received for pose in poses]),
        np.array([pose.q_cam_target for pose in poses]), np.array([pose.t_cam_target_m for pose in poses]),
        np.array([pose.covariance for pose in poses]),
    )  # fmt: skip
