"""Pictures of no craft at all that look like photographs: soft light, edges, repeated patterns."""

import cv2
import numpy as np
from jaxtyping import UInt8

from proxnav.geometry import Camera


def photograph_like(camera: Camera, rng: np.random.Generator) -> UInt8[np.ndarray, "height width"]:
    """Noise whose amplitude falls with frequency as in photographs, with shapes in front of it."""
    image = _pink(camera.height, camera.width, rng.uniform(0.8, 1.6), rng)
    for _ in range(int(rng.integers(0, 40))):
        image = _shape(image, rng)
    image = cv2.GaussianBlur(image, (0, 0), rng.uniform(0.4, 1.5))
    image += rng.normal(0.0, rng.uniform(0.002, 0.02), image.shape)
    return np.clip(255.0 * np.clip(image, 0.0, 1.0) ** rng.uniform(0.7, 2.5), 0.0, 255.0).astype(np.uint8)


def _pink(height: int, width: int, power: float, rng: np.random.Generator) -> np.ndarray:
    """Tones in [0, 1] of amplitude frequency^-power."""
    fy, fx = np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width)[None]
    amplitude = np.maximum(np.hypot(fx, fy), 1.0 / max(height, width)) ** -power
    spectrum = amplitude * np.exp(2j * np.pi * rng.random(amplitude.shape))
    image = np.fft.irfft2(spectrum, (height, width))
    low, high = np.percentile(image, (1.0, 99.0))
    return np.clip((image - low) / (high - low), 0.0, 1.0)


def _shape(image: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A polygon or an ellipse of one tone, half of them clustered in the middle as a subject would be."""
    height, width = image.shape
    centre = rng.random(2) if rng.random() < 0.5 else rng.normal(0.5, 0.1, 2)
    size = rng.uniform(0.01, 0.2) * width
    angles = np.sort(rng.uniform(0.0, 2.0 * np.pi, int(rng.integers(3, 8))))
    radii = size * rng.uniform(0.3, 1.0, len(angles))[:, None]
    corners = centre * (width, height) + radii * np.stack([np.cos(angles), rng.uniform(0.2, 1.0) * np.sin(angles)], 1)
    mask = cv2.fillPoly(np.zeros(image.shape), [np.round(corners).astype(np.int32)], 1.0)
    tone = rng.random() * (1.0 if rng.random() < 0.5 else 0.3 + 0.7 * image)
    return np.where(mask > 0.0, tone, image)
