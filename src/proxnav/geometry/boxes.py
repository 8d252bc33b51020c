"""Boxes (x0, y0, x1, y1) of what is seen [px], outer edges, corner origin; NaN where nothing is seen."""

import numpy as np
from jaxtyping import Bool, Float

from proxnav.geometry.camera import Camera
from proxnav.geometry.types import Box

_LEAST_PX = 1.0
"""What is narrower in the image shows nothing."""


def box_of_points(pixels: Float[np.ndarray, "n 2"], margin_px: Float[np.ndarray, "n 1"] | float = 0.0) -> Box:
    """The box that holds projected points with a margin around each; points without an image (NaN) are left out."""
    known = ~np.isnan(pixels).any(axis=1)
    if not known.any():
        return np.full(4, np.nan)
    low, high = (pixels - margin_px)[known].min(axis=0), (pixels + margin_px)[known].max(axis=0)
    return np.concatenate([low, high])


def cut_at_edges(box: Box, camera: Camera) -> Box:
    """The part of a box that lies in the image; without width or height where nothing of it does."""
    return np.clip(box, 0.0, np.tile([float(camera.width), float(camera.height)], 2))


def box_in_image(
    pixels: Float[np.ndarray, "n 2"], camera: Camera, margin_px: Float[np.ndarray, "n 1"] | float = 0.0
) -> Box | None:
    """The box of projected points, cut at the image's edges; None when a pixel of it or less is in the image."""
    box = cut_at_edges(box_of_points(pixels, margin_px), camera)
    return box if (box[2:] - box[:2]).min() > _LEAST_PX else None


def box_of_mask(mask: Bool[np.ndarray, "height width"]) -> Box:
    """The outer edges of the outermost pixels of a mask."""
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    if rows.size == 0:
        return np.full(4, np.nan)
    return np.array([columns[0], rows[0], columns[-1] + 1, rows[-1] + 1], dtype=np.float64)
