"""From what the caller gave to points that can be used: shapes, NaN, scores, duplicates, lens distortion."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from numpy.typing import ArrayLike

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.compiled.lens import lens_numbers, undistort_pixels
from proxnav.geometry.types import Flags
from proxnav.images.acceptance import checked_camera
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.kernels.intake import admit

_MARGIN = 1.0  # keypoints further outside the image than this many image sizes are left out


@dataclass(frozen=True, slots=True, eq=False)
class Correspondences:
    """The usable points with their pixels; the origin is moved to the centroid of the points."""

    X: Float[np.ndarray, "used 3"]
    """Points minus `centroid`, target axes [m]."""
    pixels: Float[np.ndarray, "used 2"]
    xy: Float[np.ndarray, "used 2"]
    """Where the ray meets the plane z = 1."""
    covariances: Float[np.ndarray, "used 2 2"]
    keep: Flags
    """Which of the given points these are."""
    label: Int[np.ndarray, "used"]
    """Points at the same place share a number."""
    places: int
    """Number of distinct places."""
    centroid: Float[np.ndarray, "3"]
    lens: Float[np.ndarray, "lens=18"]
    image_px2: float
    """Area of the image."""
    calibration_px: Float[np.ndarray, "used 2 calibration=3"] | None
    """Movement of the pixels by one standard deviation of each error of the calibration; None where it is exact."""


def correspondences(
    points_target_m: ArrayLike,
    points_px: ArrayLike,
    camera: Camera,
    covariances_px2: ArrayLike | None,
    scores: ArrayLike | None,
    config: PoseConfig,
) -> Correspondences:
    """The usable ones of the given points; InputError where shapes do not fit."""
    camera = checked_camera(camera)
    if (
        np.ndim(points_target_m) == np.ndim(points_px) == 2
        and np.shape(points_target_m)[1] == 2
        and np.shape(points_px)[1] == 3
    ):
        raise InputError("points and pixels are exchanged: call estimate_pose(points_target_m, points_px, camera)")
    points, pixels = _rows(points_target_m, "points_target_m", 3), _rows(points_px, "points_px", 2)
    n = len(points)
    if len(pixels) != n:
        raise InputError(f"{n} points of the target but {len(pixels)} pixels: give one pixel (NaN if not found) each")
    covariances = _covariances(covariances_px2, n, config.sigma_px)
    keep, label = np.empty(n, dtype=bool), np.empty(n, dtype=np.int64)
    size = float(camera.width), float(camera.height)
    kept, places = admit(points, pixels, covariances, _scores(scores, n), config.min_score, *size, _MARGIN, keep, label)
    xy, lens = np.empty((n, 2)), lens_numbers(camera)
    undistort_pixels(pixels, lens, xy)
    seen = ~np.isnan(xy[:, 0])
    if kept < n or not seen.all():
        keep &= seen
        points, pixels, xy, covariances, label = (a[keep] for a in (points, pixels, xy, covariances, label))
        places = len(set(label.tolist()))
    centroid = points.sum(axis=0) / max(len(points), 1)
    sigma = camera.calibration_sigma
    moves = None if sigma.is_exact else sigma.moves(pixels - (camera.cx, camera.cy))
    return Correspondences(
        points - centroid, pixels, xy, covariances, keep, label, places, centroid, lens, size[0] * size[1], moves
    )


def _rows(values: ArrayLike, name: str, width: int) -> Float[np.ndarray, "n width"]:
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != width:
        raise InputError(f"{name} needs shape (n, {width}), found {array.shape}; one row per keypoint")
    return array


def _covariances(values: ArrayLike | None, n: int, sigma_px: float) -> Float[np.ndarray, "n 2 2"]:
    if values is None:
        array = np.zeros((n, 2, 2))
        array[:, 0, 0] = array[:, 1, 1] = sigma_px**2
        return array
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.shape != (n, 2, 2):
        raise InputError(f"covariances_px2 needs shape ({n}, 2, 2), found {array.shape}; one 2x2 matrix per keypoint")
    return array


def _scores(values: ArrayLike | None, n: int) -> Float[np.ndarray, "n"]:
    if values is None:
        return np.full(n, np.inf)
    array = np.ascontiguousarray(values, dtype=np.float64)
    if array.shape != (n,):
        raise InputError(f"scores needs shape ({n},), found {array.shape}; one number per keypoint")
    return array


def as_flags(count: int, index: Int[np.ndarray, "chosen"]) -> Bool[np.ndarray, "count"]:
    """`count` flags, those in `index` set."""
    flags = np.zeros(count, dtype=bool)
    flags[index] = True
    return flags
