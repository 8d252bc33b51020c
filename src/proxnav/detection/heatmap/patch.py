"""The boxes of the brightest patches of a map of probabilities."""

import cv2
import numpy as np
from jaxtyping import Float

from proxnav.geometry.boxes import box_of_mask
from proxnav.geometry.types import Box


def brightest_patches(
    probability: Float[np.ndarray, "rows columns"], threshold: float = 0.5, most: int = 1
) -> list[Box]:
    """Boxes (x0, y0, x1, y1) [cells] of the connected patches above the threshold, the largest sum first."""
    count, patches = cv2.connectedComponents((probability > threshold).astype(np.uint8), connectivity=8)
    sums = np.bincount(patches.ravel(), weights=probability.ravel(), minlength=count)[1:]
    return [box_of_mask(patches == 1 + int(i)) for i in np.argsort(-sums)[:most]]
