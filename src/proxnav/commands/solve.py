"""`proxnav solve`: keypoints of your own detector to poses.json."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
import tyro
from jaxtyping import Float

from proxnav.cli.progress import progress
from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.keypoint_files import KeypointRecord, PixelOrigin, read_keypoints
from proxnav.storage.files import check_new_file

_POINT_FILES = {".mat", ".csv"}


@dataclass(frozen=True)
class SolveConfig:
    """Solves the pose of every image from its keypoints and writes poses.json (SPEED+ keys, status, covariance)."""

    keypoints: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="KEYPOINTS")]
    """COCO keypoint results: image_id or file_name, keypoints [x, y, score] * n, optional covariances_px2."""
    camera: Path
    """camera.json with the keys of SPEED+."""
    target: str
    """Name of a target, its file, or a .mat, .json or .csv of 3-D points [m] in the order of the keypoints."""
    out: Path = Path("poses.json")
    """File to write."""
    subset: str = ""
    """Named keypoints of the target that the file holds, such as `six`; all when empty."""
    pixel_origin: PixelOrigin = "corner"
    """Where pixel (0, 0) lies: at the `corner` of the first pixel or at its `centre` (OpenCV, most COCO detectors)."""
    pose: PoseConfig = field(default_factory=PoseConfig)


def run(config: SolveConfig) -> None:
    """Entry of `proxnav solve`."""
    check_new_file(config.out)
    camera = Camera.from_speed_json(config.camera)
    points_m = target_points(config.target, config.subset)
    keypoints = read_keypoints(config.keypoints, config.pixel_origin)
    _check_counts(keypoints, points_m, config)
    records = solve_images(keypoints, points_m, camera, config.pose)
    write_poses(config.out, records)
    statuses = Counter(record.status for record in records)
    others = ", ".join(f"{count} {status}" for status, count in statuses.items() if status != "ok")
    print(f"{statuses['ok']} poses from {len(records)} images in {config.out}" + (f"; {others}" if others else ""))


def target_points(name_or_path: str, subset: str = "") -> Float[np.ndarray, "n 3"]:
    """The 3-D keypoints [m] of a target's name or file, or the points of a .mat, .json or .csv file."""
    from proxnav.targets.keypoints.point_files import load_points
    from proxnav.targets.loading import load_target

    suffix = Path(name_or_path).suffix.lower()
    if suffix in _POINT_FILES and subset:
        raise InputError(f"{name_or_path}: a file of points has no subset '{subset}'; leave --subset out")
    if suffix in _POINT_FILES or (suffix == ".json" and not subset):
        return load_points(name_or_path)[0]
    target = load_target(name_or_path)
    return (target.with_subset(subset) if subset else target).keypoints_m


def solve_images(
    keypoints: Sequence[KeypointRecord], points_target_m: Float[np.ndarray, "n 3"], camera: Camera, config: PoseConfig
) -> list[PoseRecord]:
    """One record per image, in order."""
    from proxnav.pose.solve.estimate import estimate_pose

    records = []
    with progress("solve", len(keypoints)) as done:
        for k in keypoints:
            result = estimate_pose(points_target_m, k.pixels, camera, k.covariances_px2, k.scores, config)
            records.append(PoseRecord(k.filename, result.T_cam_target, result.status, result.covariance))
            done()
    return records


def _check_counts(keypoints: Sequence[KeypointRecord], points_m: Float[np.ndarray, "n 3"], config: SolveConfig) -> None:
    for k in keypoints:
        if len(k.pixels) != len(points_m):
            subset = f", subset '{config.subset}'" if config.subset else ""
            raise InputError(
                f"{config.keypoints}: '{k.filename}' has {len(k.pixels)} keypoints but target {config.target}{subset} "
                f"has {len(points_m)}; give the target whose points the detector finds, or name a --subset"
            )
