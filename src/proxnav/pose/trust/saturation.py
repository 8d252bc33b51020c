"""How much of the craft lies at the end of the picture's scale, where edges move outwards and shades are lost."""

import cv2
import numpy as np

from proxnav.geometry import Camera, Pose
from proxnav.geometry.types import GreyImage, Points
from proxnav.pose.local_contrast import SATURATED


def saturated_share(grey: GreyImage, camera: Camera, T_cam_target: Pose, points_target_m: Points) -> float:
    """Share of the pixels inside the hull of the projected points [m, target frame] that are white; 0 without any."""
    pixels = camera.project(T_cam_target @ points_target_m)
    corners = np.clip(pixels[np.isfinite(pixels).all(axis=1)], -1e4, 1e4)
    if len(corners) < 3:
        return 0.0
    hull = cv2.convexHull(np.round(corners - 0.5).astype(np.int32))
    inside = cv2.fillConvexPoly(np.zeros(grey.shape, np.uint8), hull, 1).astype(bool)
    return float((grey[inside] >= SATURATED).mean()) if inside.any() else 0.0
