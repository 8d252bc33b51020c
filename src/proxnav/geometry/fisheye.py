"""The fisheye lens on normalised image coordinates: the image radius is a polynomial of the angle to the axis.

theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8), OpenCV's fisheye model and Kalibr's
`equidistant`. J. Kannala, S. Brandt, "A generic camera model and calibration method for conventional, wide-angle, and
fish-eye lenses", PAMI 28(8), 2006. Rays have z = 1 here, so they end one degree before the right angle to the axis.
"""

import math

import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import Pixels

COUNT = 4
"""Number of coefficients."""
WIDEST_RAD = math.radians(89.0)
"""Largest angle to the axis."""


def distort(xy: Pixels, k: tuple[float, ...]) -> Pixels:
    """Ideal (x/z, y/z) to image coordinates for a focal length of 1."""
    r = np.linalg.norm(xy, axis=-1, keepdims=True)
    bent, _ = _bent(np.arctan(r), k)
    return xy * np.where(r > 1e-12, bent / np.maximum(r, 1e-12), 1.0)


def jacobian(xy: Pixels, k: tuple[float, ...]) -> Float[np.ndarray, "*batch 2 2"]:
    """d(image)/d(ideal)."""
    r2 = (xy * xy).sum(axis=-1)[..., None, None]
    r = np.sqrt(r2)
    bent, slope = _bent(np.arctan(r), k)
    across = np.where(r > 1e-12, bent / np.maximum(r, 1e-12), 1.0)
    along = slope / (1.0 + r2)
    outer = xy[..., :, None] * xy[..., None, :] / np.maximum(r2, 1e-24)
    return across * np.eye(2) + (along - across) * outer


def undistort(xy_image: Pixels, k: tuple[float, ...]) -> Pixels:
    """Inverse of `distort`, by Newton steps on the angle that bisection keeps in bounds; NaN where no ray leads."""
    radius = np.linalg.norm(xy_image, axis=-1, keepdims=True)
    most = largest_angle(k)
    with np.errstate(invalid="ignore"):
        low, high = np.zeros_like(radius), np.full_like(radius, most)
        theta = np.minimum(radius, most)
        for _ in range(60):
            bent, slope = _bent(theta, k)
            low, high = np.where(bent < radius, theta, low), np.where(bent < radius, high, theta)
            step = theta - (bent - radius) / np.where(slope > 0.0, slope, 1.0)
            theta = np.where((step > low) & (step < high), step, np.where(bent == radius, theta, 0.5 * (low + high)))
        reached = np.abs(_bent(theta, k)[0] - radius) < 1e-10
    ratio = np.where(radius > 1e-12, np.tan(theta) / np.maximum(radius, 1e-12), 1.0)
    return np.where(reached, xy_image * ratio, np.nan)


def largest_angle(k: tuple[float, ...]) -> float:
    """Largest angle to the axis [rad] up to which the image radius grows, at most `WIDEST_RAD`."""
    k1, k2, k3, k4 = k
    roots = np.roots([9.0 * k4, 7.0 * k3, 5.0 * k2, 3.0 * k1, 1.0])  # d theta_d / d theta, in theta^2
    real = roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0)].real
    return min(float(np.sqrt(real.min())), WIDEST_RAD) if real.size else WIDEST_RAD


def fold_radius(k: tuple[float, ...]) -> float:
    """Largest ideal radius: the tangent of `largest_angle`."""
    return math.tan(largest_angle(k))


def _bent(theta: Float[np.ndarray, "*batch"], k: tuple[float, ...]) -> tuple[np.ndarray, np.ndarray]:
    """(image radius, its derivative by the angle)."""
    k1, k2, k3, k4 = k
    t2 = theta * theta
    bent = theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
    return bent, 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))
