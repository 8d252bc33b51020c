"""Honesty of a model's poses on fresh ray-cast frames: least median score, covariances of keypoints and alignments."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from proxnav.cluster.progress import Progress, silent
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference
from proxnav.geometry.types import Image
from proxnav.learning.alignment_calibration import KEPT, Samples, calibrated
from proxnav.missions import Mission
from proxnav.missions.scenes import draw_scenes
from proxnav.pose.align import AlignConfig
from proxnav.records import SceneSpec
from proxnav.scenes.plain import BEHIND_M

_SEED = 8_000_001
_EMPTY_SEED = 8_000_003
_FEWEST = 50


@dataclass(frozen=True)
class CalibrationFrames:
    """Fresh frames of a mission, the same for every model."""

    mission: Mission
    count: int
    progress: Progress = silent

    def shown(self, job: str) -> Iterator[tuple[Image, SceneSpec]]:
        """Frames that show the target, with their scenes."""
        return self._drawn(job, self.count, _SEED, lambda scene: scene)

    def empty(self, job: str) -> Iterator[tuple[Image, SceneSpec]]:
        """A third as many frames of sky and Earth alone."""
        return self._drawn(
            job, max(1, self.count // 3), _EMPTY_SEED, lambda scene: replace(scene, t_cam_target_m=BEHIND_M)
        )

    def _drawn(
        self, job: str, count: int, seed: int, change: Callable[[SceneSpec], SceneSpec]
    ) -> Iterator[tuple[Image, SceneSpec]]:
        make = FrameJob(self.mission.target, FrameConfig("raycast"))()
        with self.progress(job, count) as done:
            for scene in draw_scenes(self.mission, count, seed):
                yield make(change(scene)).image, scene
                done()


def least_median_score(estimator: PoseEstimator, frames: CalibrationFrames) -> float:
    """Just above the best median score that passes for a pose in frames of sky and Earth alone; 0 where none does.

    Consensus is no proof of a target: what tells it apart is how sure the keypoints are, and networks differ in that.
    """
    best = 0.0
    for image, scene in frames.empty("frames without a target"):
        keypoints, result = estimator.keypoints_and_pose(image, scene.camera)
        if result.T_cam_target is not None:
            best = max(best, keypoints.median_score)
    return min(best + 0.01, 0.99) if best > 0.0 else 0.0


def spread_scale(estimator: PoseEstimator, frames: CalibrationFrames) -> float:
    """Factor on the claimed standard deviations that makes the mean NEES of poses that of 6 normals.

    Errors of neighbouring keypoints are alike, so that a pose is less certain than its keypoints one by one: the scale
    has to come from poses.
    """
    found = []
    for image, scene in frames.shown("calibrate"):
        result = estimator(image, scene.camera)
        if result.T_cam_target is not None and result.covariance is not None:
            error = difference(result.T_cam_target, scene.T_cam_target)
            found.append(float(squared_mahalanobis(error, result.covariance)))
    _check_enough(len(found), frames.count)
    return float(np.sqrt(np.mean(np.minimum(found, np.quantile(found, KEPT))) / 6.0))


def calibrated_alignment(estimator: PoseEstimator, frames: CalibrationFrames) -> AlignConfig:
    """How the model should lay outlines onto images, from its poses."""
    found = []
    for image, scene in frames.shown("calibrate the alignment"):
        aligned = estimator.alignment_of(image, scene.camera)
        if aligned is not None:
            found.append((aligned, scene.T_cam_target))
    _check_enough(len(found), frames.count)
    return calibrated(estimator.alignment, Samples.of(found, estimator.alignment))


def _check_enough(found: int, count: int) -> None:
    if found < _FEWEST:
        raise InputError(f"{found} of {count} frames gave a pose, calibration needs {_FEWEST}: train on")
