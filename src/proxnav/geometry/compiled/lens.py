"""The camera as compiled code reads it, a row of ten numbers: projection with Brown-Conrady distortion and its inverse.

The same equations as `proxnav.geometry.distortion`, one point at a time.
"""

from functools import lru_cache

import numpy as np
from jaxtyping import Float

from proxnav.geometry.camera import Camera
from proxnav.geometry.compiled.kernel import kernel, ray_kernel
from proxnav.geometry.compiled.vectors import rotate
from proxnav.geometry.distortion import fold_radius

FX, FY, CX, CY, K1, K2, P1, P2, K3, FOLD2 = range(10)
"""Places in the row: focal lengths and principal point [px, corner origin], distortion coefficients in OpenCV's order,
and the squared ideal radius beyond which the image folds back."""
_STEPS = 25


@lru_cache(maxsize=64)
def lens_numbers(camera: Camera) -> Float[np.ndarray, "lens=10"]:
    """The row of a camera."""
    fold = fold_radius(camera.distortion) if camera.is_distorted else np.inf
    return np.array((camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion, fold**2))


@kernel
def brown_conrady(x, y, lens):
    """Ideal to distorted normalised (x, y), with the symmetric Jacobian: xd, yd, dxd/dx, dxd/dy = dyd/dx, dyd/dy."""
    k1, k2, p1, p2, k3 = lens[K1], lens[K2], lens[P1], lens[P2], lens[K3]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
    xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    xx = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x
    xy = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y
    yy = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x
    return xd, yd, xx, xy, yy


@kernel
def distort(x, y, lens):
    """Ideal normalised (x, y) to pixels, with the Jacobian: u, v, du/dx, du/dy, dv/dx, dv/dy."""
    xd, yd, xx, xy, yy = brown_conrady(x, y, lens)
    fx, fy = lens[FX], lens[FY]
    return fx * xd + lens[CX], fy * yd + lens[CY], fx * xx, fx * xy, fy * xy, fy * yy


@ray_kernel
def project(R, t, point, lens, nearest):
    """Pixel (u, v) of a point seen from the pose (R, t); NaN nearer than `nearest` [m] or beyond the lens."""
    p = rotate(R, point)
    z = p[2] + t[2]
    x, y = (p[0] + t[0]) / z, (p[1] + t[1]) / z
    if not (z > nearest and x * x + y * y <= lens[FOLD2]):
        return np.nan, np.nan
    u, v, _, _, _, _ = distort(x, y, lens)
    return u, v


@ray_kernel
def undistort(xd, yd, lens):
    """Distorted to ideal normalised (x, y) by Newton steps, to 1e-13; NaN where no ray leads there."""
    x, y, error = xd, yd, np.inf
    for _ in range(_STEPS):
        xi, yi, xx, xy, yy = brown_conrady(x, y, lens)
        ex, ey, det, error = xi - xd, yi - yd, xx * yy - xy * xy, abs(xi - xd) + abs(yi - yd)
        x, y = x - (yy * ex - xy * ey) / det, y - (xx * ey - xy * ex) / det
        if error < 1e-13:
            break
    return (x, y) if error < 1e-10 and x * x + y * y <= lens[FOLD2] else (np.nan, np.nan)


@kernel
def undistort_pixels(pixels, lens, xy):
    """Fills `xy` (n, 2) with the ideal normalised coordinates of pixels (n, 2), to a billionth of a pixel."""
    for i in range(len(pixels)):
        x, y = (pixels[i, 0] - lens[CX]) / lens[FX], (pixels[i, 1] - lens[CY]) / lens[FY]
        for _ in range(20):
            u, v, ux, uy, vx, vy = distort(x, y, lens)
            du, dv, det = u - pixels[i, 0], v - pixels[i, 1], ux * vy - uy * vx
            if abs(du) + abs(dv) < 1e-11 * (lens[FX] + lens[FY]) or det == 0.0:
                break
            x, y = x - (vy * du - uy * dv) / det, y - (ux * dv - vx * du) / det
        u, v, _, _, _, _ = distort(x, y, lens)
        error = abs(u - pixels[i, 0]) + abs(v - pixels[i, 1])
        valid = error < 1e-9 * (lens[FX] + lens[FY]) and x * x + y * y <= lens[FOLD2]
        xy[i, 0], xy[i, 1] = (x, y) if valid else (np.nan, np.nan)
