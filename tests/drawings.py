"""A rigid solid drawn from any side: a prism with faces of different grey, whose six corners are the keypoints."""

from collections.abc import Iterator
from itertools import count

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from proxnav.detection.samples import SampleSource, TrainingSample

CORNERS = np.array([[-1, -0.5, -0.6], [1, -0.5, -0.6], [0, -0.5, 0.9], [-1, 0.5, -0.6], [1, 0.5, -0.6], [0, 0.5, 0.9]])
FACES = (((0, 1, 2), 250), ((5, 4, 3), 40), ((0, 3, 4, 1), 100), ((1, 4, 5, 2), 170), ((2, 5, 3, 0), 210))
SUBPIXEL_BITS = 4


def drawing(
    rng: np.random.Generator, side: int, tilt: float, size: tuple[float, float] = (0.15, 0.3)
) -> TrainingSample:
    """The prism turned by up to `tilt` [rad] about a random axis after a random roll of up to as much."""
    axis = rng.normal(size=3)
    turn = Rotation.from_rotvec(axis / np.linalg.norm(axis) * rng.uniform(0, tilt))
    corners = turn.apply(CORNERS)
    scale = rng.uniform(*size) * side
    points = corners[:, :2] * scale + side / 2 + rng.uniform(-0.15, 0.15, 2) * side
    image = np.full((side, side), rng.integers(0, 30), np.uint8)
    mask = np.zeros((side, side), np.uint8)
    visible = np.zeros(6, bool)
    for corner_ids, grey in FACES:
        ids = list(corner_ids)
        a, b, c = corners[ids[:3]]
        if np.cross(b - a, c - a)[2] < 0:  # this side faces away from the viewer, who looks along -z
            continue
        visible[ids] = True
        # fillConvexPoly counts from pixel centres, in units of 2^-bits.
        polygon = np.round((points[ids] - 0.5) * 2**SUBPIXEL_BITS).astype(np.int32)
        cv2.fillConvexPoly(image, polygon, int(grey), cv2.LINE_AA, SUBPIXEL_BITS)
        cv2.fillConvexPoly(mask, polygon, 1, cv2.LINE_8, SUBPIXEL_BITS)
    noisy = np.clip(image + rng.normal(0, 3, image.shape), 0, 255).astype(np.uint8)
    box = np.concatenate([points.min(axis=0), points.max(axis=0)])
    return TrainingSample(noisy, points, np.where(visible, 2, 1), np.clip(box, 0, side), mask.astype(bool))


def drawings(side: int, tilt: float, seed: int = 0) -> SampleSource:
    """An endless stream of drawings."""

    def source(start: int, stride: int) -> Iterator[TrainingSample]:
        return (drawing(np.random.default_rng([seed, index]), side, tilt) for index in count(start, stride))

    return source
