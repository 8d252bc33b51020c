"""Mean E_C of a Keypoint R-CNN on frames that it never learns from: what stops a training early."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np
from torch import nn

from proxnav.datasets.set.dataset import Dataset
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.keypoint_rcnn.predict import predict
from proxnav.estimator import PoseEstimator, consensus_for
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Camera, Pose
from proxnav.geometry.pose_errors import pose_errors
from proxnav.geometry.types import Image, Points
from proxnav.missions import Mission
from proxnav.missions.scenes import draw_scenes

WITHOUT_POSE = 1.0
"""E_C that a frame without a pose counts as, and the most that any frame does: one confusion must not drown a mean."""
_SEED = 7_000_002


@dataclass(frozen=True, slots=True, eq=False)
class Labelled:
    """A frame with its true pose."""

    image: Image
    camera: Camera
    T_cam_target: Pose


def fresh_frames(mission: Mission, count: int, side: int) -> Iterator[Labelled]:
    """Ray-cast frames of a mission, twice as large as the network is given them."""
    make = FrameJob(mission.target, FrameConfig("raycast"))()
    scenes = draw_scenes(mission, count, _SEED, min(2 * side, mission.camera.width))
    return (Labelled(make(scene).image, scene.camera, scene.T_cam_target) for scene in scenes)


def kept_aside(dataset: Dataset, count: int) -> Iterator[Labelled]:
    """The last `count` frames of a data set."""
    first = len(dataset) - count
    return (
        Labelled(dataset.image(k), dataset.camera, dataset.labels[k].T_cam_target) for k in range(first, first + count)
    )


def mean_e_c(
    frames: Callable[[], Iterator[Labelled]], points_m: Points, names: list[str]
) -> Callable[[nn.Module], float]:
    """The score of a network; the frames are drawn once, when they are first asked for."""
    kept: list[Labelled] = []

    def validate(network: nn.Module) -> float:
        assert isinstance(network, KeypointRcnn)
        kept.extend(() if kept else frames())
        detect = lambda image: predict(network, image, DetectConfig())  # noqa: E731
        estimate = PoseEstimator(detect, points_m, tuple(names), "", consensus_for(len(points_m)))
        return float(np.mean([_e_c(estimate, frame) for frame in kept]))

    return validate


def _e_c(estimate: PoseEstimator, frame: Labelled) -> float:
    found = estimate(frame.image, frame.camera).T_cam_target
    return WITHOUT_POSE if found is None else min(WITHOUT_POSE, pose_errors(found, frame.T_cam_target).e_c)
