"""Farthest-point sampling: few points that cover many."""

import numpy as np
from jaxtyping import Float


def farthest_points(points_m: Float[np.ndarray, "n 3"], count: int, first: int = 0) -> list[int]:
    """Indices of `count` points, each the farthest from those before it; ties go to the lower index.

    >>> farthest_points(np.array([[0.0, 0, 0], [1.0, 0, 0], [4.0, 0, 0], [3.0, 0, 0]]), 3)
    [0, 2, 1]
    """
    chosen = [first]
    gap = np.linalg.norm(points_m - points_m[first], axis=1)
    while len(chosen) < min(count, len(points_m)):
        chosen.append(int(np.argmax(gap)))
        gap = np.minimum(gap, np.linalg.norm(points_m - points_m[chosen[-1]], axis=1))
    return chosen
