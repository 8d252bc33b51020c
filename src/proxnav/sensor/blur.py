"""Blur kernels whose second moment is exact at sub-pixel size: PSF, defocus disc and motion line."""

from functools import lru_cache

import cv2
import numpy as np
from jaxtyping import Float, Float32
from scipy.special import ive

Kernel = Float[np.ndarray, "rows columns"]
Image = Float[np.ndarray, "height width *band"]
"""A rate or a share for each pixel, of a mono sensor or in three bands."""

_NEGLIGIBLE_PX = 0.05  # rms spread per axis below which a kernel is left out: it changes an edge by < 0.2 %


def gaussian(image: Image, sigma_px: float) -> Image:
    """Gaussian blur; the variance added is sigma^2 also for sigma below one pixel.

    T. Lindeberg, "Scale-space for discrete signals", PAMI 12(3), 1990: the kernel exp(-t) I_n(t) with t = sigma^2.
    """
    if sigma_px < _NEGLIGIBLE_PX:
        return image
    kernel = _lindeberg(float(sigma_px))
    return cv2.sepFilter2D(image, -1, kernel, kernel, borderType=cv2.BORDER_REPLICATE)


@lru_cache(maxsize=256)
def _lindeberg(sigma_px: float) -> Float32[np.ndarray, "taps"]:
    radius = 2 + int(np.ceil(4.0 * sigma_px))
    kernel = ive(np.abs(np.arange(-radius, radius + 1)), sigma_px**2)
    return (kernel / kernel.sum()).astype(np.float32)


def line_and_disc(motion_px: tuple[float, float], diameter_px: float) -> Kernel | None:
    """Kernel of a line from -motion/2 to motion/2 smeared by a disc; None when it is too small to matter."""
    spread = np.array([abs(motion_px[0]) / np.sqrt(12.0), abs(motion_px[1]) / np.sqrt(12.0), diameter_px / 4.0])
    if np.linalg.norm(spread) < _NEGLIGIBLE_PX:
        return None
    length = float(np.hypot(*motion_px))
    steps = max(1, int(np.ceil(4.0 * length)))
    along = (np.arange(steps) + 0.5) / steps - 0.5
    line = along[:, None] * np.array(motion_px)
    # midpoint samples of a line have a variance of L^2/12 (1 - 1/steps^2): stretched back to L^2/12
    line *= 1.0 / np.sqrt(1.0 - 1.0 / steps**2) if steps > 1 else 1.0
    points = (line[:, None] + _disc(diameter_px)[None]).reshape(-1, 2)
    return _splat(points)


def _disc(diameter_px: float) -> Float[np.ndarray, "n_points 2"]:
    """Points spread evenly over a disc (a sunflower spiral), scaled to the disc's variance of diameter^2 / 16."""
    if diameter_px < _NEGLIGIBLE_PX:
        return np.zeros((1, 2))
    count = int(np.clip(np.ceil(12.0 * diameter_px**2), 32, 4096))
    k = np.arange(count) + 0.5
    angle = k * np.pi * (3.0 - np.sqrt(5.0))
    points = np.sqrt(k / count)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    points -= points.mean(axis=0)
    whiten = np.linalg.inv(np.linalg.cholesky(np.cov(points.T, bias=True)))
    return points @ whiten.T * (0.25 * diameter_px)


def _splat(points_px: Float[np.ndarray, "n_points 2"]) -> Kernel:
    """Mean over points of Catmull-Rom weights, which keep the points' mean and variance exactly."""
    radius = int(np.ceil(np.abs(points_px).max())) + 2
    kernel = np.zeros((2 * radius + 1, 2 * radius + 1))
    cell = np.floor(points_px).astype(np.int64)
    wx, wy = (_catmull_rom(points_px[:, axis] - cell[:, axis]) for axis in (0, 1))
    for i in range(4):
        for j in range(4):
            rows, columns = cell[:, 1] + radius - 1 + i, cell[:, 0] + radius - 1 + j
            np.add.at(kernel, (rows, columns), wy[i] * wx[j])
    return (kernel / kernel.sum()).astype(np.float32)


def _catmull_rom(a: Float[np.ndarray, "n_points"]) -> Float[np.ndarray, "tap=4 n_points"]:
    """Weights of the four cells around a position `a` of the way from the second to the third."""
    a2, a3 = a * a, a * a * a
    return 0.5 * np.stack([2 * a2 - a - a3, 2 - 5 * a2 + 3 * a3, a + 4 * a2 - 3 * a3, a3 - a2])


def convolve(image: Image, kernel: Kernel | None) -> Image:
    """Convolution with a kernel that is symmetric about its centre; None leaves it."""
    if kernel is None:
        return image
    return cv2.filter2D(image, -1, kernel, borderType=cv2.BORDER_REPLICATE)
