"""Brown-Conrady lens distortion on normalised image coordinates, in OpenCV's order (k1, k2, p1, p2, k3).

D. C. Brown, "Close-range camera calibration", Photogrammetric Engineering 37(8), 1971.
"""

import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import Pixels


def distort(xy: Pixels, k: tuple[float, ...]) -> Pixels:
    """Ideal (x/z, y/z) to distorted normalised coordinates."""
    k1, k2, p1, p2, k3 = k
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    return np.stack([xd, yd], axis=-1)


def jacobian(xy: Pixels, k: tuple[float, ...]) -> Float[np.ndarray, "*batch 2 2"]:
    """d(distorted)/d(ideal)."""
    k1, k2, p1, p2, k3 = k
    x, y = xy[..., 0], xy[..., 1]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))  # d radial / d r2, times 2
    xx = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x
    yy = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x
    xy_ = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y
    return np.stack([np.stack([xx, xy_], axis=-1), np.stack([xy_, yy], axis=-1)], axis=-2)


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
    """Largest ideal radius up to which radial distortion grows monotonically; beyond it the image folds back."""
    k1, k2, _, _, k3 = k
    roots = np.roots([7.0 * k3, 5.0 * k2, 3.0 * k1, 1.0])  # d(r (1 + k1 r^2 + k2 r^4 + k3 r^6))/dr, in r^2
    real = roots[(np.abs(roots.imag) < 1e-12) & (roots.real > 0)].real
    return float(np.sqrt(real.min())) if real.size else np.inf
