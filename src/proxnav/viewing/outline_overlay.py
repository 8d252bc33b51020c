"""The outline that a pose would draw, laid over the image: whether it fits shows at a glance."""

import cv2
import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import Image
from proxnav.images.tones import grey_8_bit, rgb_8_bit
from proxnav.pose.align.outline import outline
from proxnav.pose.align.target_crop import TargetCrop, target_box
from proxnav.targets import Target
from proxnav.viewing.overlay import Canvas

_OUTLINE = (255, 140, 40)
_MOST_SIDE_PX = 1024


def outline_overlay(image: Image, camera: Camera, target: Target, T_cam_target: Pose) -> Canvas:
    """The image as RGB with the visible lines of the target at a pose, in orange."""
    canvas = rgb_8_bit(image)
    box = target_box(target, T_cam_target, camera)
    if box is None:
        return canvas
    crop = TargetCrop.around(grey_8_bit(image), box, camera, 1.1, _MOST_SIDE_PX)
    lines = outline(target, T_cam_target.R, T_cam_target.t_m, crop, 1.5)
    pixels = camera.project(T_cam_target @ lines.points_m)
    for x, y in np.floor(pixels[np.isfinite(pixels).all(axis=1)]).astype(int):
        cv2.circle(canvas, (int(x), int(y)), 0, _OUTLINE, -1)
    return canvas
