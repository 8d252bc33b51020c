"""Likeness of a predicted and a seen view of the target: correlation in a sliding window, inside the mask.

Correlation in windows forgives what no prediction knows (albedo of a part, exposure, Earth's share of the light) and
keeps what a wrong pose cannot have: edges, shadows and faces in their places. Outside the mask nothing is compared.
"""

from dataclasses import dataclass

import numpy as np

from proxnav.pose.local_contrast import FLOOR, SATURATED, Inside, View, tones, windowed

WINDOW_PX = 4.0
"""Standard deviation of the Gaussian window."""


@dataclass(frozen=True, slots=True)
class Similarity:
    """How alike two views are."""

    score: float
    """Correlation, weighted by contrast: 1 for views that are alike, near 0 for views that have nothing in common."""
    contrast: float
    """Mean standard deviation of the predicted tones in the window: where it is low, there is nothing to compare."""
    saturated: float = 0.0
    """Share of the compared pixels at the end of the picture's scale."""


def local_correlation(predicted: View, seen: View, mask: Inside) -> Similarity | None:
    """Likeness of two linear views where the prediction shows the target; None where the mask is empty."""
    if not mask.any():
        return None
    p, i = tones(predicted, mask), tones(seen, mask)
    mean_p, mean_i = windowed(p, mask, WINDOW_PX), windowed(i, mask, WINDOW_PX)
    var_p = np.maximum(windowed(p * p, mask, WINDOW_PX) - mean_p**2, 0.0)
    var_i = np.maximum(windowed(i * i, mask, WINDOW_PX) - mean_i**2, 0.0)
    covariance = windowed(p * i, mask, WINDOW_PX) - mean_p * mean_i
    local = covariance / np.sqrt((var_p + FLOOR) * (var_i + FLOOR))
    importance = np.sqrt(var_p + var_i)[mask]
    score = float((local[mask] * importance).sum() / max(importance.sum(), 1e-12))
    return Similarity(score, float(np.sqrt(var_p[mask]).mean()), float((seen[mask] >= SATURATED).mean()))
