"""Lens distortion of pinhole cameras on normalised image coordinates, in OpenCV's order of coefficients.

5: Brown-Conrady (k1, k2, p1, p2, k3), D. C. Brown, "Close-range camera calibration", Photogrammetric Engineering
37(8), 1971. 8: with (k4, k5, k6), the denominator of a rational radial term. 12: with (s1, s2, s3, s4), the thin prism.
"""

import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import Pixels

COUNTS = (5, 8, 12)
"""Numbers of coefficients."""


def distort(xy: Pixels, k: tuple[float, ...]) -> Pixels:
    """Ideal (x/z, y/z) to distorted normalised coordinates."""
    p1, p2 = k[2:4]
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial, _ = _radial(r2, k)
    xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    if len(k) == 12:
        s1, s2, s3, s4 = k[8:]
        xd, yd = xd + r2 * (s1 + r2 * s2), yd + r2 * (s3 + r2 * s4)
    return np.stack([xd, yd], axis=-1)


def jacobian(xy: Pixels, k: tuple[float, ...]) -> Float[np.ndarray, "*batch 2 2"]:
    """d(distorted)/d(ideal)."""
    p1, p2 = k[2:4]
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial, slope = _radial(r2, k)
    xx = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x
    yy = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x
    xy_ = yx = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y
    if len(k) == 12:
        s1, s2, s3, s4 = k[8:]
        a, b = 2.0 * s1 + 4.0 * s2 * r2, 2.0 * s3 + 4.0 * s4 * r2
        xx, xy_, yx, yy = xx + a * x, xy_ + a * y, yx + b * x, yy + b * y
    return np.stack([np.stack([xx, xy_], axis=-1), np.stack([yx, yy], axis=-1)], axis=-2)


def undistort(xy_distorted: Pixels, k: tuple[float, ...], iterations: int = 20) -> Pixels:
    """Inverse of `distort` by Newton steps from the distorted point; NaN where it does not converge to 1e-10."""
    xy = xy_distorted.copy()
    with np.errstate(all="ignore"):
        for _ in range(iterations):
            residual = distort(xy, k) - xy_distorted
            J = jacobian(xy, k)
            det = J[..., 0, 0] * J[..., 1, 1] - J[..., 0, 1] * J[..., 1, 0]
            dx = (J[..., 1, 1] * residual[..., 0] - J[..., 0, 1] * residual[..., 1]) / det
            dy = (J[..., 0, 0] * residual[..., 1] - J[..., 1, 0] * residual[..., 0]) / det
            xy = xy - np.stack([dx, dy], axis=-1)
        converged = np.abs(distort(xy, k) - xy_distorted).max(axis=-1) < 1e-10
        valid = converged & (np.linalg.norm(xy, axis=-1) <= fold_radius(k))
    return np.where(valid[..., None], xy, np.nan)


def fold_radius(k: tuple[float, ...]) -> float:
    """Largest ideal radius up to which radial distortion grows monotonically; beyond it the image folds back.

    The radial term is r N(r^2) / D(r^2); it stops to grow where N D + 2 s (N' D - N D') = 0 in s = r^2, or where D = 0.
    """
    k1, k2, _, _, k3 = k[:5]
    if len(k) == 5:
        candidates = np.roots([7.0 * k3, 5.0 * k2, 3.0 * k1, 1.0])  # d(r (1 + k1 r^2 + k2 r^4 + k3 r^6))/dr, in r^2
    else:
        N, D = np.array([k3, k2, k1, 1.0]), np.array([k[7], k[6], k[5], 1.0])
        growth = np.polysub(np.polymul(np.polyder(N), D), np.polymul(N, np.polyder(D)))
        slope = np.polyadd(np.polymul(N, D), np.polymul([2.0, 0.0], growth))
        candidates = np.concatenate([np.roots(slope), np.roots(D)])
    real = candidates[(np.abs(candidates.imag) < 1e-12) & (candidates.real > 0)].real
    return float(np.sqrt(real.min())) if real.size else np.inf


_Radii = Float[np.ndarray, "*batch"] | float


def _radial(r2: _Radii, k: tuple[float, ...]) -> tuple[_Radii, _Radii]:
    """(factor of the radius, twice its derivative by r^2)."""
    k1, k2, _, _, k3 = k[:5]
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
    if len(k) == 5:
        return radial, slope
    k4, k5, k6 = k[5:8]
    below = 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6))
    fall = 2.0 * (k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6))
    return radial / below, (slope * below - radial * fall) / below**2
