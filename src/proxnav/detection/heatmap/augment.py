"""What the renderer and the sensor do not vary: tone, blur and patches that hide part of the target."""

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
    erase_share: float = 0.25
    erase_size: tuple[float, float] = (0.1, 0.4)
    """Side of a hidden rectangle over the crop's side."""


def augment(sample: TrainingSample, config: AugmentConfig, rng: np.random.Generator) -> TrainingSample:
    """The sample under a random change of looks; geometry and labels stay."""
    image = sample.image
    if rng.random() < config.tone_share:
        image = _tone(image, config, rng)
    if rng.random() < config.blur_share:
        image = cv2.GaussianBlur(image, (0, 0), rng.uniform(*config.blur_sigma_px))
    if rng.random() < config.erase_share:
        image = _erase(image, config, rng)
    return replace(sample, image=image)


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
