"""The boxes of the brightest patches of a map of probabilities."""

import cv2
import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import Box


def brightest_patches(
    probability: Float[np.ndarray, "rows columns"], threshold: float = 0.5, most: int = 1
) -> list[Box]:
    """Boxes (x0, y0, x1, y1) [cells] of the connected patches above the threshold, the largest sum first."""
    count, patches = cv2.connectedComponents((probability > threshold).astype(np.uint8), connectivity=8)
    sums = np.bincount(patches.ravel(), weights=probability.ravel(), minlength=count)[1:]
    return [_box(patches == 1 + int(i)) for i in np.argsort(-sums)[:most]]


def _box(patch: np.ndarray) -> Box:
    rows, columns = np.flatnonzero(patch.any(axis=1)), np.flatnonzero(patch.any(axis=0))
    return np.array([columns[0], rows[0], columns[-1] + 1, rows[-1] + 1], dtype=np.float64)
