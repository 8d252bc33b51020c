"""Charge above full well: a share of it spills to the neighbours, the rest drains away."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry.compiled.kernel import kernel

_MAX_PASSES = 64  # how far [px] charge can travel; a strongly lit pixel would otherwise flood the image


def spill(electrons: Float[np.ndarray, "height width"], full_well_e: float, share: float) -> None:
    """Bring charge [e-] down to full well in place, handing `share` of each pixel's excess to its four neighbours.

    With share 1 charge is conserved as long as the neighbourhood has room; with share 0 this is the clip.
    """
    if share > 0.0:
        excess = np.empty_like(electrons)
        for _ in range(_MAX_PASSES):
            if _pass(electrons, excess, full_well_e, share) < 1.0:
                break
    np.minimum(electrons, np.float32(full_well_e), out=electrons)


@kernel
def _pass(electrons, excess, full_well, share):
    """One step of every pixel at once; returns the charge that moved."""
    height, width = electrons.shape
    moved = 0.0
    for i in range(height):
        for j in range(width):
            over = max(electrons[i, j] - full_well, 0.0)
            excess[i, j] = over
            moved += over
    if moved < 1.0:
        return moved
    for i in range(height):
        for j in range(width):
            if excess[i, j] > 0.0:
                electrons[i, j] -= excess[i, j]
                part = 0.25 * share * excess[i, j]
                for di, dj in ((-1, 0), (1, 0), (0, -1), (0, 1)):
                    if 0 <= i + di < height and 0 <= j + dj < width:
                        electrons[i + di, j + dj] += part
    return moved
