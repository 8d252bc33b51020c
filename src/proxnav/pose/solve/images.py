"""The pose of every image of a file of keypoints."""

from collections.abc import Callable, Sequence
from pathlib import Path

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import Points
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.estimate import estimate_pose
from proxnav.pose.solve.keypoint_files import KeypointRecord


def solve_images(
    keypoints: Sequence[KeypointRecord], points_target_m: Points, camera: Camera, config: PoseConfig,
    done: Callable[[], None] = lambda: None,
) -> list[PoseRecord]:  # fmt: skip
    """One record per image, in order; `done` is called after each."""
    records = []
    for k in keypoints:
        result = estimate_pose(points_target_m, k.pixels, camera, k.covariances_px2, k.scores, config)
        records.append(PoseRecord(k.filename, result.T_cam_target, result.status, result.covariance))
        done()
    return records


def check_counts(keypoints: Sequence[KeypointRecord], points_target_m: Points, path: Path, target: str) -> None:
    """InputError unless every image of the file `path` has a keypoint for each point of the target."""
    for k in keypoints:
        if len(k.pixels) != len(points_target_m):
            raise InputError(
                f"{path}: '{k.filename}' has {len(k.pixels)} keypoints but target {target} "
                f"has {len(points_target_m)}; give the target whose points the detector finds, or name a --subset"
            )
