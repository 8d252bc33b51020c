"""The best that the keypoints in sight of a labelled frame allow: the Cramer-Rao bound at 1 px per axis."""

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import Points
from proxnav.pose.solve.crlb import cramer_rao_white
from proxnav.records import VISIBLE, FrameLabel


def label_bound_errors(label: FrameLabel, points_target_m: Points, camera: Camera) -> tuple[float, float]:
    """(E_T [m], E_R [rad]) of the Cramer-Rao bound for the visible keypoints, each known to 1 px per axis; or NaN."""
    bound = label_bound(label, points_target_m, camera)
    if bound is None:
        return float("nan"), float("nan")
    return float(np.sqrt(np.trace(bound[:3, :3]))), float(np.sqrt(np.trace(bound[3:, 3:])))


def label_bound(label: FrameLabel, points_target_m: Points, camera: Camera) -> Float[np.ndarray, "6 6"] | None:
    """Cramer-Rao bound of the pose, translation [m] first, camera frame.

    None where fewer than four keypoints are in sight or they do not fix a pose.
    """
    visible = label.visibility == VISIBLE
    if len(visible) != len(points_target_m) or visible.sum() < 4:
        return None
    try:
        with np.errstate(divide="ignore", invalid="ignore"):  # points that are all one are refused, not warned of
            return cramer_rao_white(label.T_cam_target, points_target_m[visible], camera)
    except InputError:
        return None
