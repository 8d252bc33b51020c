"""Lens distortion for a renderer that knows pinholes only: a finer pinhole picture, resampled through the lens.

Radiance is averaged over each pixel of the distorted image. The samples lie in a box a little narrower than the pixel,
so that box, pinhole pixel and interpolation together have the second moment of the pixel itself.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float, Float32, Int

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Pixels
from proxnav.records import Window

_PAD_PX = 3  # fine pixels around, for the interpolation
_SMALLEST_PX = 4  # Blender renders no smaller picture
_LARGEST_PX = 16_384  # nor one much larger in the memory of an ordinary machine


@dataclass(frozen=True)
class Pinhole:
    """A pinhole picture that covers a window of a camera's image, `scale` times finer."""

    camera: Camera
    window: Window
    scale: int


def pinhole_for(camera: Camera, window: Window, oversampling: int) -> Pinhole | None:
    """The picture to render for a window; the window itself when the lens has no distortion. None: no ray leads in."""
    if not camera.is_distorted:
        view = camera.cropped(
            float(window.x), float(window.y), max(window.width, _SMALLEST_PX), max(window.height, _SMALLEST_PX)
        )
        return Pinhole(view, window, 1)
    xy = camera.unproject(_grid_px(window))[..., :2]
    xy = xy[np.isfinite(xy).all(axis=-1)]
    if len(xy) == 0:
        return None
    stretch = np.linalg.svd(camera.lens_jacobian(xy), compute_uv=False).max()
    fine = oversampling * max(1.0, float(stretch))
    fx, fy = camera.fx * fine, camera.fy * fine
    low = np.floor(xy.min(axis=0) * (fx, fy)) - _PAD_PX
    width, height = (np.ceil(xy.max(axis=0) * (fx, fy)) + _PAD_PX - low).astype(int)
    if max(width, height) > _LARGEST_PX:
        raise InputError(
            f"Cycles would need a pinhole picture of {width} x {height} px for so wide a lens, {_LARGEST_PX} px is the "
            "most: render with --renderer raycast, which follows every ray, or a smaller --size"
        )
    view = Camera(int(width), int(height), fx, fy, float(-low[0]), float(-low[1]))
    return Pinhole(view, window, oversampling)


def through_lens(
    picture: Float32[np.ndarray, "rows columns 4"], pinhole: Pinhole, camera: Camera
) -> Float32[np.ndarray, "h w 4"]:
    """Pixel averages of a pinhole picture over the window of the camera's image."""
    window, n = pinhole.window, pinhole.scale
    if n == 1:
        return picture[: window.height, : window.width]
    # n points per axis over a width b have variance b^2 (1 - 1/n^2) / 12; the fine pixel and the linear interpolation
    # between pixels add (1/12 + 1/6) / n^2; together they make the 1/12 of a square pixel
    b = np.sqrt((1.0 - 3.0 / n**2) / (1.0 - 1.0 / n**2))
    offsets = b * ((np.arange(n) + 0.5) / n - 0.5)
    total = np.zeros((window.height, window.width, 4), np.float32)
    for dx in offsets:
        for dy in offsets:
            at = _fine_px(centres_px(window) + np.array([dx, dy]), pinhole, camera).astype(np.float32) - 0.5
            total += cv2.remap(picture, at[..., 0], at[..., 1], cv2.INTER_LINEAR, borderValue=(0, 0, 0, 0))
    return total / n**2


def nearest(
    pixels: Float[np.ndarray, "h w 2"], pinhole: Pinhole, camera: Camera
) -> tuple[Int[np.ndarray, "h w"], Int[np.ndarray, "h w"], Bool[np.ndarray, "h w"]]:
    """(rows, columns, inside): the fine pixel nearest to each point of the image."""
    at = _fine_px(pixels, pinhole, camera)
    inside = np.all((at >= 0.0) & (at < np.array([pinhole.camera.width, pinhole.camera.height])), axis=-1)
    column, row = np.moveaxis(np.where(inside[..., None], at, 0.0).astype(int), -1, 0)
    return row, column, inside


def centres_px(window: Window) -> Float[np.ndarray, "h w 2"]:
    """The centres of a window's pixels."""
    x, y = np.meshgrid(window.x + np.arange(window.width) + 0.5, window.y + np.arange(window.height) + 0.5)
    return np.stack([x, y], axis=-1)


def _fine_px(pixels: Pixels, pinhole: Pinhole, camera: Camera) -> Pixels:
    """Where the rays of image points fall in the pinhole picture; NaN where no ray leads there."""
    xy = camera.unproject(pixels)[..., :2]
    view = pinhole.camera
    at = xy * (view.fx, view.fy) + (view.cx, view.cy)
    return at if camera.is_distorted else np.where(np.isfinite(at), at, -1e6)


def _grid_px(window: Window, steps: int = 33) -> Pixels:
    """Points over a window, its border included."""
    x = window.x + np.linspace(0.0, window.width, steps)
    y = window.y + np.linspace(0.0, window.height, steps)
    return np.stack(np.meshgrid(x, y), axis=-1)


def plane_depth(
    position_m: Float[np.ndarray, "h w 3"],
    facet: Float[np.ndarray, "h w 3"],
    rays_cam: Float[np.ndarray, "h w 3"],
    T_cam_target: Pose,
) -> Float[np.ndarray, "h w"]:
    """z in the camera frame where each ray (z = 1) meets the plane of the facet that a ray close by has hit.

    The nearby ray is half a fine pixel away at most; at grazing incidence its own depth is taken.
    """
    points_cam = T_cam_target @ position_m
    normals_cam = facet @ T_cam_target.R.T
    slant = (normals_cam * rays_cam).sum(axis=-1)
    along = (normals_cam * points_cam).sum(axis=-1)
    grazing = np.abs(slant) < 0.02
    return np.where(grazing, points_cam[..., 2], along / np.where(grazing, 1.0, slant))
