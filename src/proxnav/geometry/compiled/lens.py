"""Projection with Brown-Conrady distortion, its inverse, and what a pixel covariance weighs."""

import numpy as np

from proxnav.geometry.compiled.kernel import kernel


@kernel
def distort(x, y, lens):
    """Ideal normalised (x, y) to pixels, with the 2x2 Jacobian: u, v, du/dx, du/dy, dv/dx, dv/dy."""
    k1, k2, p1, p2, k3 = lens[4], lens[5], lens[6], lens[7], lens[8]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
    xd = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x)
    yd = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y
    cross = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y
    xx = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x
    yy = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x
    fx, fy = lens[0], lens[1]
    return fx * xd + lens[2], fy * yd + lens[3], fx * xx, fx * cross, fy * cross, fy * yy


@kernel
def undistort(pixels, lens, xy):
    """Pixels to ideal normalised coordinates by Newton steps; NaN where no ray leads there."""
    for i in range(len(pixels)):
        x, y = (pixels[i, 0] - lens[2]) / lens[0], (pixels[i, 1] - lens[3]) / lens[1]
        for _ in range(20):
            u, v, ux, uy, vx, vy = distort(x, y, lens)
            du, dv, det = u - pixels[i, 0], v - pixels[i, 1], ux * vy - uy * vx
            if abs(du) + abs(dv) < 1e-11 * (lens[0] + lens[1]) or det == 0.0:
                break
            x, y = x - (vy * du - uy * dv) / det, y - (ux * dv - vx * du) / det
        u, v, _, _, _, _ = distort(x, y, lens)
        error = abs(u - pixels[i, 0]) + abs(v - pixels[i, 1])
        valid = error < 1e-9 * (lens[0] + lens[1]) and x * x + y * y <= lens[9]
        xy[i, 0], xy[i, 1] = (x, y) if valid else (np.nan, np.nan)


@kernel
def _information(a, b, c):
    """Inverse of [[a, b], [b, c]] as (a, b, c); zeros where it is not positive definite."""
    det = a * c - b * b
    if not (det > 0.0 and a > 0.0 and det < np.inf):
        return 0.0, 0.0, 0.0
    return c / det, -b / det, a / det


@kernel
def weigh(xy, covariances, floor2, gate_floor2, lens, info, gate_info, ray_info):
    """Information of each point in pixels, the same for the gate (larger floor), and that one on the plane z = 1."""
    for i in range(len(xy)):
        a, b, c = covariances[i, 0, 0], 0.5 * (covariances[i, 0, 1] + covariances[i, 1, 0]), covariances[i, 1, 1]
        info[i, 0], info[i, 1], info[i, 2] = _information(a + floor2, b, c + floor2)
        ga, gb, gc = _information(a + gate_floor2, b, c + gate_floor2)
        gate_info[i, 0], gate_info[i, 1], gate_info[i, 2] = ga, gb, gc
        _, _, ux, uy, vx, vy = distort(xy[i, 0], xy[i, 1], lens)
        ray_info[i, 0] = ux * (ga * ux + gb * vx) + vx * (gb * ux + gc * vx)
        ray_info[i, 1] = ux * (ga * uy + gb * vy) + vx * (gb * uy + gc * vy)
        ray_info[i, 2] = uy * (ga * uy + gb * vy) + vy * (gb * uy + gc * vy)
