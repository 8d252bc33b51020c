"""Tones of a view and what is left of them when the mean and the contrast of their surroundings are taken away."""

import cv2
import numpy as np
from jaxtyping import Bool, Float

_BLUR_PX = 0.7
"""Blur of a view before it is compared with another one, which differs in sharpness."""
_BRIGHT = 98.0
"""Percentile of the tones inside the mask that counts as white."""
FLOOR = 4e-4
"""Variance that is added to that of the surroundings, so that noise in even places does not count."""
SATURATED = 254.0
"""Count of 255 from which on a pixel of the seen view says nothing."""

View = Float[np.ndarray, "side side"]
Inside = Bool[np.ndarray, "side side"]


def tones(view: View, mask: Inside) -> View:
    """Tones in [0, 1] of linear light; the root makes shot noise even."""
    white = max(float(np.percentile(view[mask], _BRIGHT)), 1e-12)
    return cv2.GaussianBlur(np.sqrt(np.clip(view / white, 0.0, 1.0)), (0, 0), _BLUR_PX)


def windowed(values: View, mask: Inside, window_px: float) -> View:
    """Mean of the values inside the mask in a Gaussian window about each pixel."""
    inside = mask.astype(np.float64)
    weight = np.maximum(cv2.GaussianBlur(inside, (0, 0), window_px), 1e-6)
    return cv2.GaussianBlur(values * inside, (0, 0), window_px) / weight


def standardised(values: View, mask: Inside, window_px: float) -> tuple[View, View]:
    """(values - mean) / deviation in the window about each pixel, and that deviation."""
    mean = windowed(values, mask, window_px)
    variance = np.maximum(windowed(values * values, mask, window_px) - mean**2, 0.0)
    return (values - mean) / np.sqrt(variance + FLOOR), np.sqrt(variance)
