"""Vertices at one place as one: what meshes from STL, glTF and CAD split, decimation and winding need whole."""

import numpy as np
from jaxtyping import Float, Int

_CELLS = 2**20
"""Places along each axis that are told apart: a millionth of the extent, about the precision of float32."""


def welded(points: Float[np.ndarray, "n 3"]) -> tuple[Int[np.ndarray, "k"], Int[np.ndarray, "n"]]:
    """(index of the first point at each place, place of each point); n as in a STL file of millions is fine."""
    low = points.min(axis=0)
    step = max(float((points.max(axis=0) - low).max()), 1e-300) / _CELLS
    cell = np.round((points - low) / step).astype(np.int64)
    key = (cell[:, 0] << 42) | (cell[:, 1] << 21) | cell[:, 2]
    _, first, place = np.unique(key, return_index=True, return_inverse=True)
    return first, place.reshape(-1)
