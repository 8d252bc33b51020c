"""The box of the brightest patch of a map of probabilities."""

import cv2
import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import Box


def largest_patch(probability: Float[np.ndarray, "rows columns"], threshold: float = 0.5) -> tuple[Box, float] | None:
    """Box (x0, y0, x1, y1) [cells] and mean probability of the connected patch with the largest sum; None if none."""
    above = (probability > threshold).astype(np.uint8)
    count, patches = cv2.connectedComponents(above, connectivity=8)
    if count < 2:
        return None
    sums = np.bincount(patches.ravel(), weights=probability.ravel())
    patch = patches == 1 + int(np.argmax(sums[1:]))
    rows, columns = np.flatnonzero(patch.any(axis=1)), np.flatnonzero(patch.any(axis=0))
    box = np.array([columns[0], rows[0], columns[-1] + 1, rows[-1] + 1], dtype=np.float64)
    return box, float(probability[patch].mean())
