"""Labels by projection: the known pose carries the target's keypoints into the image (the study's "inverse PnP")."""

import numpy as np
from jaxtyping import Bool

from proxnav.geometry.boxes import box_of_mask
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
    return FrameLabel(scene.filename, T_cam_target, pixels, visibility, box_of_mask(mask))
