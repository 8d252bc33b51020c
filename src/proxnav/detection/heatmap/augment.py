"""New views of a drawn crop: turned, zoomed and shifted, in other tones, blurred, with parts hidden.

No mirroring: the target is chiral, its mirror image is another craft.
"""

from dataclasses import dataclass, replace

import cv2
import numpy as np

from proxnav.detection.samples import TrainingSample


@dataclass(frozen=True)
class AugmentConfig:
    """Each effect happens with its share, independently."""

    tone_share: float = 0.7
    gain: tuple[float, float] = (0.5, 1.8)
    """Log-uniform factor on the counts."""
    gamma: tuple[float, float] = (0.6, 1.6)
    """Log-uniform exponent."""
    blur_share: float = 0.2
    blur_sigma_px: tuple[float, float] = (0.3, 1.2)
    turn_rad: float = 0.35
    """Most rotation of the crop about its centre: the same as a roll of the camera."""
    zoom: tuple[float, float] = (0.85, 1.2)
    """Log-uniform scale."""
    shift: float = 0.06
    """Most displacement per axis over the crop's side."""
    erase_share: float = 0.25
    erase_size: tuple[float, float] = (0.1, 0.4)
    """Side of a hidden rectangle over the crop's side."""


def augment(sample: TrainingSample, config: AugmentConfig, rng: np.random.Generator) -> TrainingSample:
    """The sample under a random similarity and a random change of looks."""
    sample = _move(sample, config, rng)
    image = sample.image
    if rng.random() < config.tone_share:
        image = _tone(image, config, rng)
    if rng.random() < config.blur_share:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(*config.blur_sigma_px))
    if rng.random() < config.erase_share:
        image = _erase(image, config, rng)
    return replace(sample, image=image)


def _move(sample: TrainingSample, config: AugmentConfig, rng: np.random.Generator) -> TrainingSample:
    """Similarity about the centre; image, mask and keypoints move together, corner origin kept."""
    h, w = sample.image.shape
    turn = config.turn_rad * rng.uniform(-1.0, 1.0)
    zoom = np.exp(rng.uniform(*np.log(config.zoom)))
    A = zoom * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    centre = np.array([w, h]) / 2.0
    b = centre - A @ centre + config.shift * np.array([w, h]) * rng.uniform(-1.0, 1.0, size=2)
    # cv2 counts from pixel centres: x_cv = x - 1/2 on both sides.
    M = np.column_stack([A, b + A @ [0.5, 0.5] - 0.5])
    smooth = cv2.INTER_LINEAR if zoom > 0.95 else cv2.INTER_AREA
    image = cv2.warpAffine(sample.image, M, (w, h), flags=smooth)
    mask = None
    if sample.mask is not None:
        mask = cv2.warpAffine(sample.mask.astype(np.uint8), M, (w, h), flags=cv2.INTER_NEAREST) > 0
    return replace(sample, image=image, mask=mask, keypoints_px=sample.keypoints_px @ A.T + b)


def _tone(image: np.ndarray, config: AugmentConfig, rng: np.random.Generator) -> np.ndarray:
    gain, gamma = (np.exp(rng.uniform(*np.log(limits))) for limits in (config.gain, config.gamma))
    table = 255.0 * np.clip(gain * (np.arange(256) / 255.0) ** gamma, 0.0, 1.0)
    return cv2.LUT(image, np.round(table).astype(np.uint8))


def _erase(image: np.ndarray, config: AugmentConfig, rng: np.random.Generator) -> np.ndarray:
    h, w = image.shape
    eh, ew = (int(side * rng.uniform(*config.erase_size)) for side in (h, w))
    y, x = rng.integers(0, h - eh), rng.integers(0, w - ew)
    image = image.copy()
    image[y : y + eh, x : x + ew] = rng.integers(0, 256) if rng.random() < 0.5 else rng.integers(0, 256, (eh, ew))
    return image
