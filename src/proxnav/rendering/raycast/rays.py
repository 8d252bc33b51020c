"""From pixels to rays and from points to the box that they cover, through the distorted camera."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Pose
from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.geometry.compiled.lens import BROWN_CONRADY, CX, CY, FX, FY, MODEL, project, undistort
from proxnav.geometry.compiled.vectors import dot, minus, plus, put, rotate

_NEAREST_M = 1e-3
_BOW, _WIDE_BOW = 0.01, 0.2  # edges between vertices bow outwards under distortion by this share, see Camera.bow


@ray_kernel
def cast(px, lens, R_target_cam, eye, centre, radius, rays, origins, directions):
    """Fills rays (n, 3) whose z in the camera is 1, in target axes, and float32 copies that start near the target.

    Embree works in float32: a ray that starts at the edge of the bounding sphere keeps its precision at any range.
    """
    for i in range(px.shape[0]):
        x, y = undistort((px[i, 0] - lens[CX]) / lens[FX], (px[i, 1] - lens[CY]) / lens[FY], lens)
        if np.isnan(x):
            put(rays[i], 0, (0.0, 0.0, 0.0))
            put(origins[i], 0, (1e9, 1e9, 1e9))
            put(directions[i], 0, (1.0, 1.0, 1.0))
            continue
        ray = rotate(R_target_cam, (x, y, 1.0))
        n2 = dot(ray, ray)
        along = dot(minus(centre, eye), ray) / n2
        put(rays[i], 0, ray)
        put(directions[i], 0, ray)
        put(origins[i], 0, plus(eye, max(0.0, along - 1.01 * radius / np.sqrt(n2)), ray))


@ray_kernel
def _box(vertices, R, t, lens):
    """Bounds of the projected vertices; NaN in the first place when some vertex has no image."""
    lo_x, lo_y, hi_x, hi_y = np.inf, np.inf, -np.inf, -np.inf
    for i in range(vertices.shape[0]):
        u, v = project(R, t, vertices[i], lens, _NEAREST_M)
        if np.isnan(u):
            return np.nan, 0.0, 0.0, 0.0
        lo_x, hi_x, lo_y, hi_y = min(lo_x, u), max(hi_x, u), min(lo_y, v), max(hi_y, v)
    return lo_x, lo_y, hi_x, hi_y


def projected_box(
    vertices: Float[np.ndarray, "n 3"], T_cam_target: Pose, lens: Float[np.ndarray, "lens=18"]
) -> tuple[float, float, float, float] | None:
    """(x0, y0, x1, y1) [px] that holds the image of the mesh with a margin; None when it cannot be bounded."""
    x0, y0, x1, y1 = _box(vertices, T_cam_target.R, T_cam_target.t_m, lens)
    if np.isnan(x0):
        return None
    margin = 2.0 + (_BOW if lens[MODEL] == BROWN_CONRADY else _WIDE_BOW) * max(x1 - x0, y1 - y0)
    return x0 - margin, y0 - margin, x1 + margin, y1 + margin
