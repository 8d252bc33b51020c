"""Pictures of the box painted by OpenCV: sides of one tone each, side by side, at eight times the resolution."""

import cv2
import numpy as np

from boxcraft import QUADS, boxcraft
from proxnav.geometry import Camera, Pose
from proxnav.targets import Target

CAMERA = Camera(width=320, height=240, fx=420.0, fy=420.0, cx=163.0, cy=118.0)
TONES = (40, 90, 130, 170, 210, 240)
FINER = 8
LINE = 40


def painted(
    T: Pose, camera: Camera = CAMERA, sky: int = 12, noise: float = 2.0, target: Target | None = None
) -> np.ndarray:
    """The box, each side in its tone; lines are bent by the lens as the camera says."""
    fine = camera.resized(camera.width * FINER, camera.height * FINER)
    image = np.full((fine.height, fine.width), sky, np.uint8)
    target = target or boxcraft()
    eye = -T.R.T @ T.t_m
    for quad, tone in zip(QUADS, TONES, strict=True):
        corners = target.vertices_m[list(quad)]
        n = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        if n @ (eye - corners[0]) > 0:
            share = np.linspace(0.0, 1.0, LINE, endpoint=False)[:, None]
            rim = np.concatenate([a + share * (b - a) for a, b in zip(corners, np.roll(corners, -1, 0), strict=True)])
            cv2.fillPoly(image, [np.round(fine.project(T @ rim) - 0.5).astype(np.int32)], tone)
    small = cv2.resize(image, (camera.width, camera.height), interpolation=cv2.INTER_AREA).astype(float)
    return np.clip(small + np.random.default_rng(1).normal(0, noise, small.shape), 0, 255).astype(np.uint8)
