"""From a box's keypoint maps to sub-pixel keypoints with covariances; numpy alone, shared by every runtime."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

RADIUS = 3
"""Half width of the window round the peak [cells]."""


@dataclass(frozen=True)
class Calibration:
    """How a map's spread becomes a covariance [px^2]: scale * (spread in pixels)^2 + floor^2."""

    scale: float = 1.0
    floor_px: float = 0.3
    """Standard deviation [px of the full image] that no keypoint falls below."""


def decode_maps(
    maps: Float[np.ndarray, "n s s"], box_xyxy: Float[np.ndarray, "4"]
) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, "n 2 2"], Float[np.ndarray, "n"]]:
    """Points, spreads and scores of logit maps that lie over a box, in the box's pixels.

    The map's cell (i, j) covers its share of the box, corner origin: its centre is (j + 0.5, i + 0.5) / s of the box.
    Point and spread are mean and covariance of the probability (softmax over all cells) in a window round its peak,
    where a second mode does not pull them; the score is the probability in that window.
    """
    n, side, _ = maps.shape
    p = np.exp(maps - maps.max(axis=(1, 2), keepdims=True)).astype(np.float64)
    p /= p.sum(axis=(1, 2), keepdims=True)
    row, column = np.divmod(p.reshape(n, -1).argmax(axis=1), side)
    steps = np.arange(-RADIUS, RADIUS + 1)
    rows, columns = row[:, None] + steps, column[:, None] + steps
    at = np.arange(n)[:, None, None], rows.clip(0, side - 1)[:, :, None], columns.clip(0, side - 1)[:, None, :]
    exists = ((rows >= 0) & (rows < side))[:, :, None] & ((columns >= 0) & (columns < side))[:, None, :]
    window = p[at] * exists
    score = window.sum(axis=(1, 2))
    window /= score[:, None, None]
    x = np.einsum("nij,nj->n", window, columns + 0.5)
    y = np.einsum("nij,ni->n", window, rows + 0.5)
    dx, dy = columns + 0.5 - x[:, None], rows + 0.5 - y[:, None]
    xx, yy = np.einsum("nij,nj->n", window, dx**2), np.einsum("nij,ni->n", window, dy**2)
    xy = np.einsum("nij,ni,nj->n", window, dy, dx)
    cell = (box_xyxy[2:] - box_xyxy[:2]) / side
    points = box_xyxy[:2] + np.stack([x, y], axis=1) * cell
    spread = np.stack([np.stack([xx, xy], -1), np.stack([xy, yy], -1)], axis=-2)
    return points, spread * np.outer(cell, cell), score


def covariances(
    spread: Float[np.ndarray, "n 2 2"], px_per_network_px: float, calibration: Calibration
) -> Float[np.ndarray, "n 2 2"]:
    """Covariances [px^2 of the full image] of points whose maps have this spread in the network's pixels."""
    return calibration.scale * spread * px_per_network_px**2 + calibration.floor_px**2 * np.eye(2)
