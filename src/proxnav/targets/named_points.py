"""3-D points by the name of a target, by its file, or by a file of points alone."""

from pathlib import Path

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.types import Points
from proxnav.targets.keypoints.point_files import load_points
from proxnav.targets.loading import load_target
from proxnav.targets.target import Target

_POINT_FILES = {".mat", ".csv"}
_LARGEST_M = 150.0
"""Span of points that no spacecraft has; the International Space Station has 109 m."""


def target_points(name_or_path: str, subset: str = "") -> Points:
    """The keypoints [m] of a target's name or file, or the points of a .mat, .json or .csv file."""
    suffix = Path(name_or_path).suffix.lower()
    if suffix in _POINT_FILES and subset:
        raise InputError(f"{name_or_path}: a file of points has no subset '{subset}'; leave --subset out")
    if suffix in _POINT_FILES or (suffix == ".json" and not subset):
        return _spacecraft_sized(Path(name_or_path))[0]
    target = load_target(name_or_path)
    return (target.with_subset(subset) if subset else target).keypoints_m


def target_or_points(name_or_path: str) -> tuple[Target | None, Points, tuple[str, ...]]:
    """(the target, unless the file holds points alone; its points [m]; their names)."""
    path = Path(name_or_path)
    if path.suffix.lower() in (*_POINT_FILES, ".json") and not path.with_name("mesh.npz").is_file():
        return None, *_spacecraft_sized(path)
    target = load_target(name_or_path)
    return target, target.keypoints_m, target.keypoint_names


def _spacecraft_sized(path: Path) -> tuple[Points, tuple[str, ...]]:
    """The points of a file and their names; InputError where they span more than any spacecraft."""
    points, names = load_points(path)
    span = float(np.linalg.norm(np.ptp(points, axis=0)))
    if span > _LARGEST_M:
        raise InputError(
            f"{path}: the points span {span:.4g} m, more than any spacecraft: are they in mm? Give metres, or name the "
            "columns of a csv x_mm, y_mm, z_mm"
        )
    return points, names
