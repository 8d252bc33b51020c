"""Labels by projection: the known pose carries the target's keypoints into the image (the study's "inverse PnP")."""

import numpy as np
from jaxtyping import Bool

from proxnav.records import HIDDEN, NOT_IN_IMAGE, VISIBLE, FrameLabel, SceneSpec
from proxnav.targets import Target


def label_frame(
    scene: SceneSpec,
    target: Target,
    mask: Bool[np.ndarray, "height width"],
    unoccluded: Bool[np.ndarray, "n_keypoints"],
) -> FrameLabel:
    """Truth of a frame: s [u v 1]^T = K [R|t] [p 1]^T with the lens distortion in between (the study's Eq. 1).

    `mask` is the target in the full image; `unoccluded` says which keypoints no part of the target hides.
    """
    T_cam_target = scene.T_cam_target
    pixels = scene.camera.project(T_cam_target @ target.keypoints_m)
    inside = scene.camera.contains(pixels)
    visibility = np.where(inside, np.where(unoccluded, VISIBLE, HIDDEN), NOT_IN_IMAGE)
    return FrameLabel(scene.filename, T_cam_target, pixels, visibility, mask_box(mask))


def mask_box(mask: Bool[np.ndarray, "height width"]) -> np.ndarray:
    """(4,) x0, y0, x1, y1 [px]: outer edges of the outermost pixels of the mask; NaN for an empty mask."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if rows.size == 0:
        return np.full(4, np.nan)
    return np.array([columns[0], rows[0], columns[-1] + 1, rows[-1] + 1], dtype=np.float64)
