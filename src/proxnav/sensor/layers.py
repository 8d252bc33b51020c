"""Blur of a scene in two layers, the target and what is behind it, each by its own defocus and motion."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera
from proxnav.records import ExposureSpec, RenderedFrame, SensorSpec
from proxnav.sensor import blur, motion
from proxnav.sensor.photometry import focal_length_m


@dataclass(frozen=True, slots=True, eq=False)
class LayerKernels:
    """What blurs each layer; None is no blur."""

    target: blur.Kernel | None
    background: blur.Kernel | None


def layer_kernels(
    frame: RenderedFrame,
    sensor: SensorSpec,
    exposure: ExposureSpec,
    exposure_s: float,
    camera: Camera,
    pixel_scale: float,
) -> LayerKernels:
    """Kernels at the centre of the target (mean position of its pixels) and, for the background, of the window.

    `pixel_scale` is pixels of the frame per pixel of the sensor.
    """
    if motion.is_still(exposure) and sensor.focus_m <= 0.0:
        return LayerKernels(None, None)
    window = frame.window
    middle = np.array([window.x + 0.5 * window.width, window.y + 0.5 * window.height])
    ray = _ray(camera, middle)
    far_px = motion.background_velocity_px(ray, exposure, camera) * exposure_s
    focal_m = focal_length_m(sensor, camera) / pixel_scale
    far_disc = defocus_m(np.inf, sensor, focal_m) / sensor.pixel_pitch_m * pixel_scale
    background = blur.line_and_disc((float(far_px[0]), float(far_px[1])), far_disc)
    point = _target_centre(frame, camera)
    if point is None:
        return LayerKernels(None, background)
    near_px = motion.target_velocity_px(point, exposure, camera) * exposure_s
    near_disc = defocus_m(float(point[2]), sensor, focal_m) / sensor.pixel_pitch_m * pixel_scale
    return LayerKernels(blur.line_and_disc((float(near_px[0]), float(near_px[1])), near_disc), background)


def defocus_m(depth_m: float, sensor: SensorSpec, focal_m: float) -> float:
    """Diameter [m] of the circle of confusion: f^2 |d - d0| / (N d (d0 - f)); 0 when no focus distance is set."""
    if sensor.focus_m <= focal_m:
        return 0.0
    relative = 1.0 if np.isinf(depth_m) else abs(depth_m - sensor.focus_m) / depth_m
    return focal_m**2 * relative / (sensor.f_number * (sensor.focus_m - focal_m))


def blur_layers(image: blur.Image, coverage: Float[np.ndarray, "height width"], kernels: LayerKernels) -> blur.Image:
    """The image with the target's part and the background blurred apart and composed again.

    The background is continued under the target from its surroundings, as far as its kernel reaches.
    """
    if kernels.target is None and kernels.background is None:
        return image
    if not (coverage > 0.0).any():
        return blur.convolve(image, kernels.background)
    if (coverage >= 1.0).all():
        return blur.convolve(image, kernels.target)
    share = _like(coverage, image)
    behind = blur.convolve(_background(image, coverage, kernels), kernels.background)
    target = blur.convolve(image * share, kernels.target)
    covered = np.clip(_like(blur.convolve(coverage, kernels.target), image), 0.0, 1.0)
    return target + (1.0 - covered) * behind


def _background(image: blur.Image, coverage: Float[np.ndarray, "height width"], kernels: LayerKernels) -> blur.Image:
    """The image where the target leaves it free, continued beneath it by the mean of what is near and free."""
    free = 1.0 - coverage
    reach = max(len(kernel) for kernel in (kernels.target, kernels.background) if kernel is not None) | 1
    size = (2 * reach + 1, 2 * reach + 1)
    near = cv2.boxFilter(image * _like(free, image), -1, size, borderType=cv2.BORDER_REPLICATE)
    weight = cv2.boxFilter(free, -1, size, borderType=cv2.BORDER_REPLICATE)
    filled = near / np.maximum(_like(weight, image), 1e-6)
    return np.where(_like(coverage, image) > 0.0, filled, image)


def _like(plane: Float[np.ndarray, "height width"], image: blur.Image) -> Float[np.ndarray, "height width *one"]:
    """The plane with an axis for bands where the image has one."""
    return plane if image.ndim == 2 else plane[..., None]


def _target_centre(frame: RenderedFrame, camera: Camera) -> Float[np.ndarray, "3"] | None:
    """Mean position [m] of the seen surface in the camera frame; None without target."""
    seen = np.isfinite(frame.depth_m)
    if not seen.any():
        return None
    depth = float(frame.depth_m[seen].mean())
    row, column = (indices.mean() for indices in np.nonzero(seen))
    return depth * _ray(camera, np.array([frame.window.x + column + 0.5, frame.window.y + row + 0.5]))


def _ray(camera: Camera, pixel: Float[np.ndarray, "2"]) -> Float[np.ndarray, "3"]:
    ray = camera.unproject(pixel)
    return ray if np.isfinite(ray).all() else np.array([0.0, 0.0, 1.0])
