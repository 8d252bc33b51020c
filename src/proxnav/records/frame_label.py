"""What is true about one image: pose, keypoints, visibility and box."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from proxnav.geometry import Pose
from proxnav.geometry.arrays import frozen
from proxnav.geometry.types import Box

NOT_IN_IMAGE, HIDDEN, VISIBLE = 0, 1, 2
"""COCO's visibility codes; hidden points are labelled where they project."""


@dataclass(frozen=True, slots=True, eq=False)
class FrameLabel:
    """Truth of one image. Keypoints follow the target's keypoint list."""

    filename: str
    T_cam_target: Pose
    keypoints_px: Float[np.ndarray, "n_keypoints 2"]
    """Keypoints [px] projected through the camera with its distortion, corner origin; NaN behind the camera."""
    visibility: Int[np.ndarray, "n_keypoints"]
    """0 outside the image, 1 hidden by the target itself, 2 visible."""
    box_xyxy: Box
    """Box of the mask [px], the edges of its outermost pixels; NaN when nothing is seen."""

    def __post_init__(self) -> None:
        n = len(self.keypoints_px)
        object.__setattr__(self, "keypoints_px", frozen(self.keypoints_px, (n, 2), "keypoints_px"))
        object.__setattr__(self, "visibility", frozen(self.visibility, (n,), "visibility", np.int64))
        object.__setattr__(self, "box_xyxy", frozen(self.box_xyxy, (4,), "box_xyxy"))
