"""Part textures as one table of texels with all their mip levels, prefiltered so that one lookup stands for a pixel.

Colours, metallic and alpha average linearly; the colours of matt and of metal are kept apart, since bright metal
lines on dark cells would average to grey cells otherwise. Normal maps are kept as mean slopes and their second moment:
what a level averages away comes back as roughness (M. Olano, D. Baker, "LEAN mapping", I3D 2010).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import cv2
import numpy as np
from jaxtyping import Float32, Float64, Int32
from numba import njit

from proxnav.targets import Material

CHANNELS = 12
"""Colour of the matt share (3), metallic, colour of the metal share (3), alpha, slope along u, slope along v, half of
the slopes' second moment, unused."""


_SHARPER = 0.8  # bilinear lookups widen texels of size s to a variance of 3 s^2 / 12; a pixel has 1 / 12: s = 2^-0.8


class SurfaceTexture(Protocol):
    """What `proxnav.targets.textures` gives for one part."""

    @property
    def tile_m(self) -> float: ...
    @property
    def albedo(self) -> np.ndarray: ...
    @property
    def metallic(self) -> np.ndarray: ...
    @property
    def roughness(self) -> np.ndarray: ...
    @property
    def ior(self) -> float: ...
    @property
    def normal(self) -> np.ndarray | None: ...


@dataclass(frozen=True, slots=True, eq=False)
class TexelTable:
    """All parts' textures in the layout that `sample` reads."""

    texels: Float32[np.ndarray, "n_texels 12"]
    levels: Int32[np.ndarray, "n_levels 3"]
    """First texel, height and width of each level."""
    parts: Float64[np.ndarray, "n_parts 8"]
    """First level, number of levels, tile along u and v [m], index of refraction, emission (3)."""
    means: Float32[np.ndarray, "n_parts 12"]
    """The coarsest texel of each part, for light that bounces."""

    @property
    def mean_albedo(self) -> Float32[np.ndarray, "n_parts 3"]:
        """What the whole part reflects on average."""
        return self.means[:, :3] + self.means[:, 4:7]


def build_table(textures: Sequence[SurfaceTexture], materials: Sequence[Material]) -> TexelTable:
    """The table of one texture per part."""
    texels, levels, parts, means = [], [], [], []
    count = 0
    for texture, material in zip(textures, materials, strict=True):
        chain = _mip_chain(_pack(texture))
        tile = np.broadcast_to(np.asarray(texture.tile_m, dtype=np.float64), (2,))
        parts.append([len(levels), len(chain), *tile, texture.ior, *material.emission])
        for level in chain:
            levels.append([count, *level.shape[:2]])
            texels.append(level.reshape(-1, CHANNELS))
            count += len(texels[-1])
        means.append(chain[-1].reshape(CHANNELS))
    return TexelTable(
        np.ascontiguousarray(np.concatenate(texels), np.float32), np.array(levels, np.int32), np.array(parts),
        np.array(means, np.float32),
    )  # fmt: skip


def _pack(texture: SurfaceTexture) -> np.ndarray:
    """(h, w, 12) float32 of one texture."""
    packed = np.zeros((*texture.albedo.shape[:2], CHANNELS), np.float32)
    metallic = np.asarray(texture.metallic)[..., None]
    packed[..., :3] = (1.0 - metallic) * texture.albedo
    packed[..., 3:4] = metallic
    packed[..., 4:7] = metallic * texture.albedo
    packed[..., 7] = np.asarray(texture.roughness) ** 2
    if texture.normal is not None:
        slope = texture.normal[..., :2] / np.maximum(texture.normal[..., 2:], 0.1)
        if slope.shape[:2] != packed.shape[:2]:
            slope = cv2.resize(slope, packed.shape[1::-1], interpolation=cv2.INTER_AREA)
        packed[..., 8:10] = slope
        packed[..., 10] = 0.5 * (slope**2).sum(axis=-1)
    return packed


def _mip_chain(level: np.ndarray) -> list[np.ndarray]:
    """The texture and its halvings down to one texel."""
    chain = [level]
    while max(chain[-1].shape[:2]) > 1:
        h, w = (max(1, size // 2) for size in chain[-1].shape[:2])
        halves = [cv2.resize(chain[-1][..., c : c + 4], (w, h), interpolation=cv2.INTER_AREA) for c in (0, 4, 8)]
        chain.append(np.concatenate([half.reshape(h, w, 4) for half in halves], axis=-1))
    return chain


@njit(cache=True, nogil=True, error_model="numpy")
def _bilinear(texels, first, h, w, u, v, weight, out):
    x, y = (u - np.floor(u)) * w - 0.5, (v - np.floor(v)) * h - 0.5
    x0, y0 = int(np.floor(x)), int(np.floor(y))
    fx, fy = x - x0, y - y0
    xa, xb = (x0 + w) % w, (x0 + 1) % w
    ya, yb = (y0 + h) % h, (y0 + 1) % h
    waa, wab = weight * (1.0 - fy) * (1.0 - fx), weight * (1.0 - fy) * fx
    wba, wbb = weight * fy * (1.0 - fx), weight * fy * fx
    aa, ab, ba, bb = first + ya * w + xa, first + ya * w + xb, first + yb * w + xa, first + yb * w + xb
    for c in range(11):
        out[c] += waa * texels[aa, c] + wab * texels[ab, c] + wba * texels[ba, c] + wbb * texels[bb, c]


@njit(cache=True, nogil=True, error_model="numpy")
def sample(texels, levels, part, u_m, v_m, footprint_m, out):
    """Fills `out` (12) with the texture at (u, v) [m] averaged over `footprint_m`; 10 is the slopes' variance."""
    first, count = int(part[0]), int(part[1])
    u, v = u_m / part[2], v_m / part[3]
    texel = np.sqrt(part[2] * part[3] / (levels[first, 1] * levels[first, 2]))
    level = min(max(np.log2(max(footprint_m, 1e-9) / texel) - _SHARPER, 0.0), count - 1.0)
    low = min(int(level), count - 1)
    blend = level - low
    for c in range(11):
        out[c] = 0.0
    _bilinear(texels, levels[first + low, 0], levels[first + low, 1], levels[first + low, 2], u, v, 1.0 - blend, out)
    if blend > 0.0:
        high = first + low + 1
        _bilinear(texels, levels[high, 0], levels[high, 1], levels[high, 2], u, v, blend, out)
    # at the finest level the normal itself is interpolated: nothing has been averaged away yet
    out[10] = max(0.0, out[10] - 0.5 * (out[8] * out[8] + out[9] * out[9])) * min(level, 1.0)
