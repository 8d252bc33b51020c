"""From a picture and its texture coordinates in a file to a tile of nearly square texels on the surface."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.targets.surface.part_image import PartImage, linear_to_srgb, srgb_to_linear

MAX_TEXELS = 2**20
"""Texels of all parts of a target together: what a new look of it costs grows with them."""
MAX_SIDE = 1024
_MARGIN = 2
"""Texels left about a part's share of a picture, for interpolation."""

CornerUv = Float[np.ndarray, "n_faces corner=3 2"]
Corners = Float[np.ndarray, "n_faces corner=3 3"]


@dataclass(frozen=True, slots=True, eq=False)
class Picture:
    """A picture that a file lays over a mesh."""

    image: Any
    """PIL image."""
    corner_uv: CornerUv
    """Texture coordinates, 1 a picture, v upwards."""


def image_tile(
    picture: Picture, corners_m: Corners, factor: Float[np.ndarray, "3"], most_texels: int
) -> tuple[PartImage, CornerUv]:
    """The tile, its colours times `factor`, and the texture coordinates [m] of each corner on it.

    Where a part uses a piece of the picture, that piece is cut out. A picture that is stretched over the surface is
    repeated along its shorter side, so that one length in metres serves along both: lookups average over squares.
    """
    texels, uv = _cut(
        _pixels(picture.image), np.stack([picture.corner_uv[..., 0], 1.0 - picture.corner_uv[..., 1]], -1)
    )
    length_u, length_v = _lengths(uv, corners_m)
    repeat = int(np.clip(np.round(np.log2(length_u / length_v)), -4, 4))
    times_u, times_v = 2 ** max(-repeat, 0), 2 ** max(repeat, 0)
    tile_m = float(np.sqrt(length_u * times_u * length_v * times_v))
    h, w = _size(texels.shape, times_v, times_u, most_texels)
    texels = np.tile(_resized(texels, h // times_v, w // times_u), (times_v, times_u, 1))
    srgb = np.round(255.0 * linear_to_srgb(np.clip(texels * factor, 0.0, 1.0))).astype(np.uint8)
    return PartImage(tile_m, srgb), uv / [times_u, times_v] * tile_m


def mean_albedo(image: PartImage, corner_uv_m: CornerUv, corners_m: Corners) -> tuple[float, float, float]:
    """Linear albedo at the middles of the faces, averaged by their area."""
    h, w = image.srgb.shape[:2]
    middle = corner_uv_m.mean(axis=1) / image.tile_m % 1.0
    texel = image.srgb[
        np.minimum((middle[:, 1] * h).astype(int), h - 1), np.minimum((middle[:, 0] * w).astype(int), w - 1)
    ]
    area = (
        np.linalg.norm(np.cross(corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0]), axis=1) + 1e-15
    )
    if len(area) < 64:  # few large faces: the whole picture tells more than their middles
        texel, area = image.srgb.reshape(-1, 3), np.ones(h * w)
    red, green, blue = np.average(srgb_to_linear(texel / 255.0), axis=0, weights=area).tolist()
    return red, green, blue


def _pixels(image: Any) -> Float[np.ndarray, "h w 3"]:
    """Linear colours of the picture, at most twice as fine as any tile."""
    small = image.convert("RGB")
    small.thumbnail((2 * MAX_SIDE, 2 * MAX_SIDE))
    return srgb_to_linear(np.asarray(small, np.float64) / 255.0)


def _cut(texels: Float[np.ndarray, "h w 3"], uv: CornerUv) -> tuple[Float[np.ndarray, "h2 w2 3"], CornerUv]:
    """The piece of the picture that `uv` (v with the row) uses, and `uv` on it; the whole where it repeats."""
    size = np.array(texels.shape[1::-1])
    low, high = np.floor(uv.min(axis=(0, 1)) * size) - _MARGIN, np.ceil(uv.max(axis=(0, 1)) * size) + _MARGIN
    if (low < -_MARGIN - 1).any() or (high > size + _MARGIN + 1).any():
        return texels, uv
    low, high = np.clip(low, 0, size).astype(int), np.clip(high, 0, size).astype(int)
    low, high = np.minimum(low, size - 1), np.maximum(high, np.minimum(low, size - 1) + 1)
    whole = (high - low) > 0.8 * size
    low, high = np.where(whole, 0, low), np.where(whole, size, high)
    return texels[low[1] : high[1], low[0] : high[0]], (uv * size - low) / (high - low)


def _lengths(uv: CornerUv, corners_m: Corners) -> tuple[float, float]:
    """Metres on the surface for one picture along u and along v: medians by area, as smeared triangles have any."""
    e1, e2 = corners_m[:, 1] - corners_m[:, 0], corners_m[:, 2] - corners_m[:, 0]
    (u1, v1), (u2, v2) = (uv[:, 1] - uv[:, 0]).T, (uv[:, 2] - uv[:, 0]).T
    det, area = u1 * v2 - u2 * v1, np.linalg.norm(np.cross(e1, e2), axis=1)
    usable = (np.abs(det) > 1e-12) & (area > 0)
    if not usable.any():
        return 1.0, 1.0
    e1, e2, weight = e1[usable], e2[usable], area[usable]
    du = (e1 * v2[usable, None] - e2 * v1[usable, None]) / det[usable, None]
    dv = (e2 * u1[usable, None] - e1 * u2[usable, None]) / det[usable, None]
    along = [_median(np.linalg.norm(d, axis=1), weight) for d in (du, dv)]
    return max(along[0], 1e-6), max(along[1], 1e-6)


def _median(values: Float[np.ndarray, "n"], weight: Float[np.ndarray, "n"]) -> float:
    order = np.argsort(values)
    share = np.cumsum(weight[order])
    return float(values[order[np.searchsorted(share, 0.5 * share[-1])]])


def _size(shape: tuple[int, ...], times_v: int, times_u: int, most_texels: int) -> tuple[int, int]:
    """(rows, columns), powers of two, about as fine as the picture, at most `most_texels` together."""
    h, w = (int(2 ** np.ceil(np.log2(n))) for n in (shape[0] * times_v, shape[1] * times_u))
    while h > MAX_SIDE or w > MAX_SIDE or h * w > most_texels:
        h, w = (max(h // 2, times_v), w) if h >= w else (h, max(w // 2, times_u))
        if h == times_v and w == times_u:
            break
    return h, w


def _resized(texels: Float[np.ndarray, "h w 3"], h: int, w: int) -> Float[np.ndarray, "h2 w2 3"]:
    import cv2

    shrinks = h * w <= texels.shape[0] * texels.shape[1]
    return cv2.resize(texels, (w, h), interpolation=cv2.INTER_AREA if shrinks else cv2.INTER_LINEAR)
