"""From pixels to rays and from points to the box that they cover, through the distorted camera."""

import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry import distortion as lens
from proxnav.geometry.compiled.kernel import ray_kernel

_STEPS = 25


def camera_numbers(camera: Camera) -> np.ndarray:
    """(fx, fy, cx, cy, k1, k2, p1, p2, k3, fold radius) as the kernels read them."""
    fold = lens.fold_radius(camera.distortion) if camera.is_distorted else np.inf
    return np.array([camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion, fold])


@ray_kernel
def _undistort(xd, yd, k):
    """Ideal coordinates of a distorted point by Newton steps; NaN where no ray leads there.

    The same equations and the same acceptance as `proxnav.geometry.distortion.undistort`.
    """
    k1, k2, p1, p2, k3 = k[4], k[5], k[6], k[7], k[8]
    x, y = xd, yd
    for _ in range(_STEPS):
        r2 = x * x + y * y
        radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
        slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3))
        ex = x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x) - xd
        ey = y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y - yd
        xx = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x
        yy = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x
        xy = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y
        det = xx * yy - xy * xy
        x -= (yy * ex - xy * ey) / det
        y -= (xx * ey - xy * ex) / det
        if abs(ex) + abs(ey) < 1e-13:
            break
    valid = abs(ex) < 1e-10 and abs(ey) < 1e-10 and x * x + y * y <= k[9] * k[9]
    return (x, y) if valid else (np.nan, np.nan)


@ray_kernel
def cast(px, k, R_target_cam, eye, centre, radius, rays, origins, directions):
    """Fills rays (n, 3) whose z in the camera is 1, in target axes, and float32 copies that start near the target.

    Embree works in float32: a ray that starts at the edge of the bounding sphere keeps its precision at any range.
    """
    distorted = k[4] != 0.0 or k[5] != 0.0 or k[6] != 0.0 or k[7] != 0.0 or k[8] != 0.0
    R = R_target_cam
    for i in range(px.shape[0]):
        x, y = (px[i, 0] - k[2]) / k[0], (px[i, 1] - k[3]) / k[1]
        if distorted:
            x, y = _undistort(x, y, k)
        if np.isnan(x):
            rays[i, 0] = rays[i, 1] = rays[i, 2] = 0.0
            origins[i, 0] = origins[i, 1] = origins[i, 2] = 1e9
            directions[i, 0] = directions[i, 1] = directions[i, 2] = 1.0
            continue
        dx = R[0, 0] * x + R[0, 1] * y + R[0, 2]
        dy = R[1, 0] * x + R[1, 1] * y + R[1, 2]
        dz = R[2, 0] * x + R[2, 1] * y + R[2, 2]
        n2 = dx * dx + dy * dy + dz * dz
        along = ((centre[0] - eye[0]) * dx + (centre[1] - eye[1]) * dy + (centre[2] - eye[2]) * dz) / n2
        start = max(0.0, along - 1.01 * radius / np.sqrt(n2))
        rays[i, 0], rays[i, 1], rays[i, 2] = dx, dy, dz
        directions[i, 0], directions[i, 1], directions[i, 2] = dx, dy, dz
        origins[i, 0], origins[i, 1], origins[i, 2] = eye[0] + start * dx, eye[1] + start * dy, eye[2] + start * dz


@ray_kernel
def _box(vertices, R, t, k):
    """Bounds of the projected vertices; NaN in the first place when some vertex has no image."""
    lo_x, lo_y, hi_x, hi_y = np.inf, np.inf, -np.inf, -np.inf
    for i in range(vertices.shape[0]):
        v0, v1, v2 = np.float64(vertices[i, 0]), np.float64(vertices[i, 1]), np.float64(vertices[i, 2])
        z = R[2, 0] * v0 + R[2, 1] * v1 + R[2, 2] * v2 + t[2]
        if z <= 1e-3:
            return np.nan, 0.0, 0.0, 0.0
        x = (R[0, 0] * v0 + R[0, 1] * v1 + R[0, 2] * v2 + t[0]) / z
        y = (R[1, 0] * v0 + R[1, 1] * v1 + R[1, 2] * v2 + t[1]) / z
        r2 = x * x + y * y
        if r2 > k[9] * k[9]:
            return np.nan, 0.0, 0.0, 0.0
        radial = 1.0 + r2 * (k[4] + r2 * (k[5] + r2 * k[8]))
        u = (x * radial + 2.0 * k[6] * x * y + k[7] * (r2 + 2.0 * x * x)) * k[0] + k[2]
        v = (y * radial + k[6] * (r2 + 2.0 * y * y) + 2.0 * k[7] * x * y) * k[1] + k[3]
        lo_x, hi_x, lo_y, hi_y = min(lo_x, u), max(hi_x, u), min(lo_y, v), max(hi_y, v)
    return lo_x, lo_y, hi_x, hi_y


def projected_box(vertices: np.ndarray, T_cam_target: Pose, k: np.ndarray) -> tuple[float, float, float, float] | None:
    """(x0, y0, x1, y1) [px] that holds the image of the mesh with a margin; None when it cannot be bounded."""
    x0, y0, x1, y1 = _box(vertices, T_cam_target.R, T_cam_target.t_m, k)
    if np.isnan(x0):
        return None
    margin = 2.0 + 0.01 * max(x1 - x0, y1 - y0)  # edges between vertices bulge under distortion
    return x0 - margin, y0 - margin, x1 + margin, y1 + margin
