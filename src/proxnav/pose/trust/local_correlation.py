"""Likeness of a predicted and a seen view of the target: correlation in a sliding window, inside the mask.

Correlation in windows forgives what no prediction knows (albedo of a part, exposure, Earth's share of the light) and
keeps what a wrong pose cannot have: edges, shadows and faces in their places. Outside the mask nothing is compared.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool, Float

WINDOW_PX = 4.0
"""Standard deviation of the Gaussian window."""
_BLUR_PX = 0.7
"""Blur of both views, which differ in sharpness."""
_BRIGHT = 98.0
"""Percentile of the tones inside the mask that counts as white."""
SATURATED = 254.0
"""Count of 255 from which on a pixel of the seen view says nothing."""
_FLOOR = 4e-4
"""Variance that is added to both, so that noise in even places does not count."""

View = Float[np.ndarray, "side side"]


@dataclass(frozen=True, slots=True)
class Similarity:
    """How alike two views are."""

    score: float
    """Correlation, weighted by contrast: 1 for views that are alike, near 0 for views that have nothing in common."""
    contrast: float
    """Mean standard deviation of the predicted tones in the window: where it is low, there is nothing to compare."""
    saturated: float = 0.0
    """Share of the compared pixels at the end of the picture's scale."""


def local_correlation(predicted: View, seen: View, mask: Bool[np.ndarray, "side side"]) -> Similarity | None:
    """Likeness of two linear views where the prediction shows the target; None where the mask is empty."""
    if not mask.any():
        return None
    inside = mask.astype(np.float64)
    p, i = _tones(predicted, mask), _tones(seen, mask)
    weight = np.maximum(_window(inside), 1e-6)
    mean_p, mean_i = _window(p * inside) / weight, _window(i * inside) / weight
    var_p = np.maximum(_window(p * p * inside) / weight - mean_p**2, 0.0)
    var_i = np.maximum(_window(i * i * inside) / weight - mean_i**2, 0.0)
    covariance = _window(p * i * inside) / weight - mean_p * mean_i
    local = covariance / np.sqrt((var_p + _FLOOR) * (var_i + _FLOOR))
    importance = np.sqrt(var_p + var_i)[mask]
    score = float((local[mask] * importance).sum() / max(importance.sum(), 1e-12))
    return Similarity(score, float(np.sqrt(var_p[mask]).mean()), float((seen[mask] >= SATURATED).mean()))


def _tones(view: View, mask: Bool[np.ndarray, "side side"]) -> View:
    """Tones in [0, 1]; the root makes shot noise even."""
    white = max(float(np.percentile(view[mask], _BRIGHT)), 1e-12)
    return cv2.GaussianBlur(np.sqrt(np.clip(view / white, 0.0, 1.0)), (0, 0), _BLUR_PX)


def _window(values: View) -> View:
    return cv2.GaussianBlur(values, (0, 0), WINDOW_PX)
