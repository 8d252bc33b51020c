"""Offsets that a converter adds to whole rows or columns: found in the differences of neighbouring lines, taken out.

Rows of offsets look like edges to whatever reads edges. A scene changes slowly from line to line in most of its pixels,
offsets change in all of them at once.
"""

import numpy as np
from jaxtyping import Float, Int16

from proxnav.geometry.types import GreyImage

_NOTICED, _SURELY = 1.0, 3.0
"""Robust standard deviation of the jumps between neighbouring lines, in counts and over what the scene's own pixels
would make of it, below which nothing is taken out."""
_EDGE = 45
"""Difference of neighbouring pixels [counts] beyond which it is the scene's."""
_NEAR = 15.0
"""The same about the mean of the line."""
_FEWEST = 12
"""Pixels without which a line tells nothing about its neighbour."""
_SMOOTH = 31
"""Lines over which offsets are compared: slower changes are the scene's."""
_EVERY = 4
"""Pixels of a line of which one is looked at."""


def without_line_offsets(grey: GreyImage) -> GreyImage:
    """The image without offsets of its rows and columns; the same object where it has none."""
    rows, columns = line_offsets(grey), line_offsets(grey.T)
    if rows is None and columns is None:
        return grey
    level = grey.astype(np.float32)
    if rows is not None:
        level -= rows[:, None]
    if columns is not None:
        level -= columns[None, :]
    found = np.clip(np.rint(level), 0, 255).astype(np.uint8)
    clipped = (grey == 0) | (grey == 255)
    return np.where(clipped, grey, found)


def line_offsets(grey: GreyImage) -> Float[np.ndarray, "lines"] | None:
    """Offset of each row [counts] against the rows about it; None where neighbouring rows hardly differ."""
    jumps, error = _jumps(grey[:, ::_EVERY].astype(np.int16))
    if len(jumps) < _SMOOTH:
        return None
    if 1.4826 * float(np.median(np.abs(jumps))) < max(_NOTICED, _SURELY * error):
        return None
    levels = np.concatenate([[0.0], np.cumsum(jumps)])
    return levels - _slow(levels)


def _jumps(lines: Int16[np.ndarray, "lines pixels"]) -> tuple[Float[np.ndarray, "steps"], float]:
    """Mean difference of each line from the one before, and the usual standard error of that.

    Over pixels that are neither clipped nor on an edge; where nearly all are clipped, in a black sky, over all.
    """
    step = np.diff(lines, axis=0)
    open_ = (lines > 0) & (lines < 255)
    even = np.abs(step) < _EDGE
    kept = open_[1:] & open_[:-1] & even
    kept = np.where((kept.sum(axis=1) < _FEWEST)[:, None], even, kept)
    near = kept & (np.abs(step - _mean(step, kept)[:, None]) < _NEAR)
    jumps = _mean(step, near)
    variance = _mean(np.square(step, dtype=np.float32), near) - jumps**2
    return jumps, float(np.median(np.sqrt(np.maximum(variance, 0.0) / np.maximum(near.sum(axis=1), 1))))


def _mean(values: np.ndarray, kept: np.ndarray) -> Float[np.ndarray, "steps"]:
    return np.where(kept, values, 0).sum(axis=1) / np.maximum(kept.sum(axis=1), 1)


def _slow(levels: Float[np.ndarray, "lines"]) -> Float[np.ndarray, "lines"]:
    """Running mean, its ends mirrored."""
    half = _SMOOTH // 2
    padded = np.pad(levels, half, mode="reflect")
    return np.convolve(padded, np.full(_SMOOTH, 1.0 / _SMOOTH), mode="valid")
