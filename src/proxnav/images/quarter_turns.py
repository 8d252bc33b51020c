"""Square images turned by quarters, and what was found in them turned back."""

import numpy as np
from jaxtyping import Float, Shaped

from proxnav.geometry.types import Pixels


def turned(square: Shaped[np.ndarray, "side side"], quarters: int) -> Shaped[np.ndarray, "side side"]:
    """The image turned counter-clockwise, as seen, by so many right angles."""
    return np.rot90(square, quarters)


def turned_back(
    pixels: Pixels, covariances_px2: Float[np.ndarray, "n 2 2"], side: int, quarters: int
) -> tuple[Pixels, Float[np.ndarray, "n 2 2"]]:
    """Points of the turned image, corner origin, with their covariances, in the image before it was turned.

    >>> turned_back(np.array([[0.5, 0.5]]), np.eye(2)[None], 4, 1)[0]
    array([[3.5, 0.5]])
    """
    back = np.linalg.matrix_power(np.array([[0.0, -1.0], [1.0, 0.0]]), quarters % 4)
    middle = 0.5 * side
    return (pixels - middle) @ back.T + middle, back @ covariances_px2 @ back.T
