"""Part textures as one table of texels with all their mip levels, prefiltered so that one lookup stands for a pixel.

Colours, metallic and alpha average linearly; the colours of matt and of metal are kept apart, since bright metal
lines on dark cells would average to grey cells otherwise. Normal maps are kept as mean slopes and their second moment:
what a level averages away comes back as roughness (M. Olano, D. Baker, "LEAN mapping", I3D 2010).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Float64, Int32

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.rendering.raycast.mip_levels import (
    CHANNELS,
    MATT,
    METAL,
    MOMENT,
    PLANES,
    SLOPE_U,
    SLOPE_V,
    Surface,
    fill_levels,
    surface_size,
)
from proxnav.targets import Material

START, HEIGHT, WIDTH = range(3)
"""Places in a level: its first texel, rows and columns."""
FIRST_LEVEL, LEVELS, TILE_U, TILE_V, IOR, EMISSION, SKIPPED, TEXEL_M = 0, 1, 2, 3, 4, 5, 8, 9
"""Places in a part: first level, number of levels, tile along u and v [m], index of refraction, emission (3), number of
finer levels that were left out, side of a texel of the finest of all [m]."""
_SHARPER = 0.8  # bilinear lookups widen texels of size s to a variance of 3 s^2 / 12; a pixel has 1 / 12: s = 2^-0.8


@dataclass(frozen=True, slots=True, eq=False)
class TexelTable:
    """All parts' textures in the layout that `sample` reads."""

    texels: Float32[np.ndarray, "n_texels 12"]
    """Places as `mip_levels` names them."""
    levels: Int32[np.ndarray, "n_levels 3"]
    """START, HEIGHT, WIDTH of each level."""
    parts: Float64[np.ndarray, "n_parts 10"]
    """FIRST_LEVEL to TEXEL_M of each part."""
    means: Float32[np.ndarray, "n_parts 12"]
    """The coarsest texel of each part, for light that bounces."""

    @property
    def mean_albedo(self) -> Float32[np.ndarray, "n_parts 3"]:
        """What the whole part reflects on average."""
        return self.means[:, MATT : MATT + 3] + self.means[:, METAL : METAL + 3]

    @property
    def emission(self) -> Float64[np.ndarray, "n_parts 3"]:
        """Radiance that each part emits [W/(m^2 sr)]."""
        return self.parts[:, EMISSION : EMISSION + 3]


def build_table(surfaces: Sequence[Surface], materials: Sequence[Material], finest_m: float = 0.0) -> TexelTable:
    """The table of one surface per part, without the levels that footprints of `finest_m` and more do not read.

    Leaving them out changes no value that `sample` gives for such footprints, not by a bit.
    """
    chains = [_chain(surface, finest_m) for surface in surfaces]
    sizes = np.array([size for chain in chains for size in chain.sizes], np.int32)
    first = np.concatenate([[0], np.cumsum(sizes.prod(axis=1))]).astype(np.int32)
    texels = np.empty((first[-1], CHANNELS), np.float32)
    parts, means, row = [], [], 0
    for surface, material, chain in zip(surfaces, materials, chains, strict=True):
        end = row + len(chain.sizes)
        fill_levels(surface, chain.skip, sizes[row:end], texels[first[row] : first[end]])
        parts.append(
            [row, end - row, chain.tile_m, chain.tile_m, surface.ior, *material.emission, chain.skip, chain.texel_m]
        )
        means.append(texels[first[end] - 1])
        row = end
    levels = np.concatenate([first[:-1, None], sizes], axis=1)
    return TexelTable(texels, levels, np.array(parts), np.array(means))


@dataclass(frozen=True, slots=True)
class _Chain:
    """The mip levels of one texture that are kept."""

    sizes: list[tuple[int, int]]
    """(rows, columns) of each, down to one texel."""
    skip: int
    """Number of finer ones that are not."""
    tile_m: float
    texel_m: float
    """Side of a texel of the finest level, kept or not."""


def _chain(surface: Surface, finest_m: float) -> _Chain:
    h, w = surface_size(surface)
    sizes = [(h, w)]
    while max(sizes[-1]) > 1:
        sizes.append((max(1, sizes[-1][0] // 2), max(1, sizes[-1][1] // 2)))
    texel = float(surface.tile_m / np.sqrt(h * w))
    level = np.log2(max(0.999 * finest_m, 1e-9) / texel) - _SHARPER
    skip = int(np.clip(np.floor(level), 0, len(sizes) - 1))
    return _Chain(sizes[skip:], skip, surface.tile_m, texel)


@ray_kernel
def _add_bilinear(texels, level, u, v, weight, out):
    first, h, w = level[START], level[HEIGHT], level[WIDTH]
    x, y = (u - np.floor(u)) * w - 0.5, (v - np.floor(v)) * h - 0.5
    x0, y0 = int(np.floor(x)), int(np.floor(y))
    fx, fy = x - x0, y - y0
    xa, xb = (x0 + w) % w, (x0 + 1) % w
    ya, yb = (y0 + h) % h, (y0 + 1) % h
    waa, wab = weight * (1.0 - fy) * (1.0 - fx), weight * (1.0 - fy) * fx
    wba, wbb = weight * fy * (1.0 - fx), weight * fy * fx
    aa, ab, ba, bb = first + ya * w + xa, first + ya * w + xb, first + yb * w + xa, first + yb * w + xb
    for c in range(PLANES):
        out[c] += waa * texels[aa, c] + wab * texels[ab, c] + wba * texels[ba, c] + wbb * texels[bb, c]


@ray_kernel
def sample(texels, levels, part, u_m, v_m, footprint_m, out):
    """Fills `out` with the texel at (u, v) [m] averaged over `footprint_m`; MOMENT with half the slopes' variance."""
    first, count, skip = int(part[FIRST_LEVEL]), int(part[LEVELS]), int(part[SKIPPED])
    u, v = u_m / part[TILE_U], v_m / part[TILE_V]
    level = min(max(np.log2(max(footprint_m, 1e-9) / part[TEXEL_M]) - _SHARPER, np.float64(skip)), skip + count - 1.0)
    low = min(int(level), skip + count - 1)
    blend = level - low
    for c in range(PLANES):
        out[c] = 0.0
    at = first + low - skip
    _add_bilinear(texels, levels[at], u, v, 1.0 - blend, out)
    if blend > 0.0:
        _add_bilinear(texels, levels[at + 1], u, v, blend, out)
    # at the finest level the normal itself is interpolated: nothing has been averaged away yet
    variance = max(0.0, out[MOMENT] - 0.5 * (out[SLOPE_U] * out[SLOPE_U] + out[SLOPE_V] * out[SLOPE_V]))
    out[MOMENT] = variance * min(level, 1.0)
