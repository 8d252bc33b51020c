"""What the estimator saw, drawn over the image: keypoints with their ellipses, true and estimated axes."""

import cv2
import numpy as np
from jaxtyping import Float, UInt8

from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Image, Pixels, Points
from proxnav.images.tones import rgb_8_bit
from proxnav.records import Keypoints

_TRUE, _FOUND, _AXES = (90, 220, 90), (255, 200, 40), ((235, 70, 70), (70, 210, 70), (80, 130, 255))
_SUBPIXEL = 4  # bits of cv2's fixed-point coordinates
Canvas = UInt8[np.ndarray, "height width 3"]
"""An RGB picture."""


def overlay(
    image: Image,
    camera: Camera,
    T_estimate: Pose | None = None,
    T_true: Pose | None = None,
    points_target_m: Points | None = None,
    keypoints: Keypoints | None = None,
    axis_m: float | None = None,
) -> Canvas:
    """The image as RGB with: true keypoints (green crosses), found ones with 3-sigma ellipses (yellow), body axes.

    The estimated axes (x red, y green, z blue) are solid; the true ones are thin and white. They are `axis_m` long,
    half of the farthest keypoint's distance from the origin where it is None.
    """
    canvas = rgb_8_bit(image)
    if axis_m is None:
        axis_m = 2.0 if points_target_m is None else 0.5 * float(np.linalg.norm(points_target_m, axis=1).max())
    if T_true is not None:
        if points_target_m is not None:
            for pixel in camera.project(T_true @ points_target_m):
                _cross(canvas, pixel)
        _axes(canvas, camera, T_true, axis_m, ((255, 255, 255),) * 3, 1)
    if keypoints is not None:
        for pixel, covariance in zip(keypoints.pixels, keypoints.covariances_px2, strict=True):
            _ellipse(canvas, pixel, covariance)
    if T_estimate is not None:
        _axes(canvas, camera, T_estimate, axis_m, _AXES, 2)
    return canvas


def caption(canvas: Canvas, lines: list[str]) -> Canvas:
    """Lines of text in the upper left corner, on a dark ground."""
    canvas = canvas.copy()
    scale = max(canvas.shape[1] / 1024.0, 0.65)  # legible in small images too
    height = round(26 * scale)
    canvas[: height * len(lines) + 8] //= 2
    for row, line in enumerate(lines, 1):
        place = (8, height * row)
        cv2.putText(canvas, line, place, cv2.FONT_HERSHEY_SIMPLEX, 0.7 * scale, (255, 255, 255), 1, cv2.LINE_AA)
    return canvas


def contact_sheet(
    images: list[Image], columns: int = 4, side: int = 384
) -> UInt8[np.ndarray, "sheet_height sheet_width 3"]:
    """Images as one RGB sheet of square tiles."""
    tiles = [cv2.resize(rgb_8_bit(image), (side, side), interpolation=cv2.INTER_AREA) for image in images]
    blank = np.zeros_like(tiles[0])
    tiles += [blank] * (-len(tiles) % columns)
    return np.vstack([np.hstack(tiles[i : i + columns]) for i in range(0, len(tiles), columns)])


def _fixed(pixel: Pixels) -> tuple[int, int] | None:
    """cv2's fixed-point coordinates of a corner-origin pixel; None when it is not a drawable point."""
    if not np.isfinite(pixel).all() or np.abs(pixel).max() > 1e5:
        return None
    x, y = np.round((pixel - 0.5) * (1 << _SUBPIXEL)).astype(int)
    return int(x), int(y)


def _axes(canvas: Canvas, camera: Camera, T: Pose, length_m: float, colours: tuple, width: int) -> None:
    ends = camera.project(T @ np.vstack([np.zeros(3), np.eye(3) * length_m]))
    start = _fixed(ends[0])
    for end, colour in zip(ends[1:], colours, strict=True):
        tip = _fixed(end)
        if start is not None and tip is not None:
            cv2.line(canvas, start, tip, colour, width, cv2.LINE_AA, _SUBPIXEL)


def _cross(canvas: Canvas, pixel: Pixels) -> None:
    if np.isfinite(pixel).all() and np.abs(pixel).max() < 1e5:
        place = tuple(int(v) for v in np.floor(pixel))
        cv2.drawMarker(canvas, place, _TRUE, cv2.MARKER_CROSS, 9, 1, cv2.LINE_AA)


def _ellipse(canvas: Canvas, pixel: Pixels, covariance: Float[np.ndarray, "2 2"]) -> None:
    centre = _fixed(pixel)
    if centre is None or not np.isfinite(covariance).all():
        return
    variances, axes = np.linalg.eigh(covariance)
    half = np.clip(3.0 * np.sqrt(np.maximum(variances, 0.0)), 1.0, 500.0) * (1 << _SUBPIXEL)
    angle = np.degrees(np.arctan2(axes[1, 0], axes[0, 0]))
    size = (int(half[0]), int(half[1]))
    cv2.ellipse(canvas, centre, size, angle, 0.0, 360.0, _FOUND, 1, cv2.LINE_AA, _SUBPIXEL)
    cv2.circle(canvas, centre, 2 << _SUBPIXEL, _FOUND, -1, cv2.LINE_AA, _SUBPIXEL)
