"""Which pixels the target can touch."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose
from proxnav.records import Window

MARGIN_PX = 2


def target_window(vertices_m: Float[np.ndarray, "n 3"], T_cam_target: Pose, camera: Camera, within: Window) -> Window:
    """The part of `within` that holds the image of a mesh; its size is zero when the mesh is out of sight."""
    points_cam = T_cam_target @ vertices_m
    ahead = points_cam[:, 2] > 1e-3
    if not ahead.any():
        return Window(within.x, within.y, 0, 0)
    pixels = camera.project(points_cam)
    if not (ahead.all() and np.isfinite(pixels).all()):
        return within  # some vertex has no image: the box of the others bounds nothing
    low, high = pixels.min(axis=0), pixels.max(axis=0)
    margin = MARGIN_PX + camera.bow * (high - low).max()
    return _clip(np.floor(low - margin), np.ceil(high + margin), within)


def _clip(low: Float[np.ndarray, "2"], high: Float[np.ndarray, "2"], within: Window) -> Window:
    x0, y0 = np.maximum(low, (within.x, within.y)).astype(int)
    x1, y1 = np.minimum(high, (within.x + within.width, within.y + within.height)).astype(int)
    if x1 <= x0 or y1 <= y0:
        return Window(within.x, within.y, 0, 0)
    return Window(int(x0), int(y0), int(x1 - x0), int(y1 - y0))
