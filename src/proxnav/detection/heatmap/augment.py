"""New views of a drawn crop: turned, zoomed and shifted, in other tones, blurred, with parts hidden.

No mirroring: the target is chiral, its mirror image is another craft.
"""

from dataclasses import replace
from typing import Literal

import cv2
import numpy as np

from proxnav.detection.samples import TrainingSample
from proxnav.geometry.types import GreyImage

TONE_SHARE, BLUR_SHARE, ERASE_SHARE = 0.7, 0.2, 0.25
"""Shares of the samples that each effect happens to, independently."""
GAIN, GAMMA = (0.5, 1.8), (0.6, 1.6)
"""Limits of the log-uniform factor on the counts, and of the log-uniform exponent."""
BLUR_SIGMA_PX = (0.3, 1.2)
Turns = Literal["small", "any"]
"""Rotations of the crop about its centre, each the same as a roll of the camera: small ones, or these on quarter turns,
which leave a square crop whole."""
TURN_RAD = 0.35
"""Most rotation of the small ones."""
ZOOM = (0.85, 1.2)
"""Limits of the log-uniform scale."""
SHIFT = 0.06
"""Most displacement per axis over the crop's side."""
ERASE_SIZE = (0.1, 0.4)
"""Limits of the side of a hidden rectangle over the crop's side."""


def augment(sample: TrainingSample, rng: np.random.Generator, turns: Turns = "small") -> TrainingSample:
    """The sample under a random similarity and a random change of tones."""
    sample = moved(sample, rng, turns)
    image = sample.image
    if rng.random() < TONE_SHARE:
        image = _tone(image, rng)
    if rng.random() < BLUR_SHARE:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(*BLUR_SIGMA_PX))
    if rng.random() < ERASE_SHARE:
        image = _erase(image, rng)
    return replace(sample, image=image)


def moved(sample: TrainingSample, rng: np.random.Generator, turns: Turns = "small") -> TrainingSample:
    """The sample under a similarity about its centre; image, mask and keypoints move together, corner origin kept."""
    h, w = sample.image.shape
    turn = TURN_RAD * rng.uniform(-1.0, 1.0)
    if turns == "any":
        turn += 0.5 * np.pi * rng.integers(4)
    zoom = np.exp(rng.uniform(*np.log(ZOOM)))
    A = zoom * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    centre = np.array([w, h]) / 2.0
    b = centre - A @ centre + SHIFT * np.array([w, h]) * rng.uniform(-1.0, 1.0, size=2)
    # cv2 counts from pixel centres: x_cv = x - 1/2 on both sides.
    M = np.column_stack([A, b + A @ [0.5, 0.5] - 0.5])
    smooth = cv2.INTER_LINEAR if zoom > 0.95 else cv2.INTER_AREA
    image = cv2.warpAffine(sample.image, M, (w, h), flags=smooth)
    mask = None
    if sample.mask is not None:
        mask = cv2.warpAffine(sample.mask.astype(np.uint8), M, (w, h), flags=cv2.INTER_NEAREST) > 0
    return replace(sample, image=image, mask=mask, keypoints_px=sample.keypoints_px @ A.T + b)


def _tone(image: GreyImage, rng: np.random.Generator) -> GreyImage:
    gain, gamma = (np.exp(rng.uniform(*np.log(limits))) for limits in (GAIN, GAMMA))
    table = 255.0 * np.clip(gain * (np.arange(256) / 255.0) ** gamma, 0.0, 1.0)
    return cv2.LUT(image, np.round(table).astype(np.uint8))


def _erase(image: GreyImage, rng: np.random.Generator) -> GreyImage:
    h, w = image.shape
    eh, ew = (int(side * rng.uniform(*ERASE_SIZE)) for side in (h, w))
    y, x = rng.integers(0, h - eh), rng.integers(0, w - ew)
    image = image.copy()
    image[y : y + eh, x : x + ew] = rng.integers(0, 256) if rng.random() < 0.5 else rng.integers(0, 256, (eh, ew))
    return image
