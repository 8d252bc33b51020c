"""The camera as compiled code reads it, a row of numbers: projection through its lens and the inverse.

The same equations as `proxnav.geometry.distortion` and `proxnav.geometry.fisheye`, one point at a time.
"""

import math
from functools import lru_cache

import numpy as np
from jaxtyping import Float

from proxnav.geometry.camera import Camera
from proxnav.geometry.compiled.kernel import kernel, ray_kernel
from proxnav.geometry.compiled.vectors import rotate

FX, FY, CX, CY, K1, K2, P1, P2, K3, FOLD2, MODEL, K4, K5, K6, S1, S2, S3, S4 = range(18)
"""Places in the row: focal lengths and principal point [px, corner origin], distortion coefficients in OpenCV's order,
the squared ideal radius beyond which the image folds back, and which of the models below it is."""
FISHEYE_COEFFICIENTS = slice(K1, K1 + 4)
"""Where a fisheye has its own four."""
BROWN_CONRADY, RATIONAL, FISHEYE = 0.0, 1.0, 2.0
"""Models: 5 coefficients of a pinhole, 8 or 12 of them, 4 of a fisheye."""
_STEPS = 25


@lru_cache(maxsize=64)
def lens_numbers(camera: Camera) -> Float[np.ndarray, "lens=18"]:
    """The row of a camera."""
    row, k = np.zeros(18), camera.distortion
    row[[FX, FY, CX, CY, FOLD2]] = camera.fx, camera.fy, camera.cx, camera.cy, camera.fold_radius**2
    if camera.projection == "fisheye":
        row[MODEL], row[FISHEYE_COEFFICIENTS] = FISHEYE, k
        return row
    row[MODEL] = BROWN_CONRADY if len(k) == 5 else RATIONAL
    row[K1 : K3 + 1], row[K4 : K4 + len(k) - 5] = k[:5], k[5:]
    return row


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
def rational(x, y, lens):
    """The same of a rational radial term and a thin prism, whose Jacobian is not symmetric: xd, yd, xx, xy, yx, yy."""
    k1, k2, p1, p2, k3 = lens[K1], lens[K2], lens[P1], lens[P2], lens[K3]
    k4, k5, k6 = lens[K4], lens[K5], lens[K6]
    r2 = x * x + y * y
    above, below = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3)), 1.0 + r2 * (k4 + r2 * (k5 + r2 * k6))
    if below == 0.0:
        return np.nan, np.nan, 1.0, 0.0, 0.0, 1.0
    rise, fall = k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3), k4 + r2 * (2.0 * k5 + r2 * 3.0 * k6)
    radial, slope = above / below, 2.0 * (rise * below - above * fall) / (below * below)
    xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) + r2 * (lens[S1] + r2 * lens[S2])
    yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y + r2 * (lens[S3] + r2 * lens[S4])
    a, b = 2.0 * lens[S1] + 4.0 * lens[S2] * r2, 2.0 * lens[S3] + 4.0 * lens[S4] * r2
    across = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y
    xx = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x + a * x
    yy = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x + b * y
    return xd, yd, xx, across + a * y, across + b * x, yy


@kernel
def _bent(theta, lens):
    """Image radius of a fisheye at an angle to the axis, and its derivative."""
    k1, k2, k3, k4 = lens[K1], lens[K1 + 1], lens[K1 + 2], lens[K1 + 3]
    t2 = theta * theta
    radius = theta * (1.0 + t2 * (k1 + t2 * (k2 + t2 * (k3 + t2 * k4))))
    return radius, 1.0 + t2 * (3.0 * k1 + t2 * (5.0 * k2 + t2 * (7.0 * k3 + t2 * 9.0 * k4)))


@kernel
def fisheye(x, y, lens):
    """The same of a fisheye."""
    r2 = x * x + y * y
    r = math.sqrt(r2)
    if r < 1e-12:
        return x, y, 1.0, 0.0, 0.0, 1.0
    radius, slope = _bent(math.atan(r), lens)
    across = radius / r
    turn = (slope / (1.0 + r2) - across) / r2
    xy = turn * x * y
    return x * across, y * across, across + turn * x * x, xy, xy, across + turn * y * y


@kernel
def _fisheye_ray(xd, yd, lens):
    """Fisheye image to ideal normalised (x, y): Newton steps on the angle that bisection keeps in bounds."""
    radius = math.sqrt(xd * xd + yd * yd)
    if radius < 1e-12:
        return xd, yd
    low, high = 0.0, math.atan(math.sqrt(lens[FOLD2]))
    theta = min(radius, high)
    for _ in range(60):
        bent, slope = _bent(theta, lens)
        error = bent - radius
        if abs(error) < 1e-14:
            break
        if error < 0.0:
            low = theta
        else:
            high = theta
        step = theta - error / slope if slope > 0.0 else -1.0
        theta = step if low < step < high else 0.5 * (low + high)
    if not abs(_bent(theta, lens)[0] - radius) < 1e-10:
        return np.nan, np.nan
    ratio = math.tan(theta) / radius
    return xd * ratio, yd * ratio


@kernel
def through_lens(x, y, lens):
    """Ideal to distorted normalised (x, y), with the Jacobian: xd, yd, dxd/dx, dxd/dy, dyd/dx, dyd/dy."""
    if lens[MODEL] == BROWN_CONRADY:
        xd, yd, xx, xy, yy = brown_conrady(x, y, lens)
        return xd, yd, xx, xy, xy, yy
    if lens[MODEL] == RATIONAL:
        return rational(x, y, lens)
    return fisheye(x, y, lens)


@kernel
def distort(x, y, lens):
    """Ideal normalised (x, y) to pixels, with the Jacobian: u, v, du/dx, du/dy, dv/dx, dv/dy."""
    xd, yd, xx, xy, yx, yy = through_lens(x, y, lens)
    fx, fy = lens[FX], lens[FY]
    return fx * xd + lens[CX], fy * yd + lens[CY], fx * xx, fx * xy, fy * yx, fy * yy


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
    if lens[MODEL] == FISHEYE:
        return _fisheye_ray(xd, yd, lens)
    x, y, error = xd, yd, np.inf
    for _ in range(_STEPS):
        xi, yi, xx, xy, yx, yy = through_lens(x, y, lens)
        ex, ey, det, error = xi - xd, yi - yd, xx * yy - xy * yx, abs(xi - xd) + abs(yi - yd)
        x, y = x - (yy * ex - xy * ey) / det, y - (xx * ey - yx * ex) / det
        if error < 1e-13:
            break
    return (x, y) if error < 1e-10 and x * x + y * y <= lens[FOLD2] else (np.nan, np.nan)


@kernel
def undistort_pixels(pixels, lens, xy):
    """Fills `xy` (n, 2) with the ideal normalised coordinates of pixels (n, 2), to a billionth of a pixel."""
    for i in range(len(pixels)):
        x, y = (pixels[i, 0] - lens[CX]) / lens[FX], (pixels[i, 1] - lens[CY]) / lens[FY]
        if lens[MODEL] == FISHEYE:
            xy[i, 0], xy[i, 1] = _fisheye_ray(x, y, lens)
            continue
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
