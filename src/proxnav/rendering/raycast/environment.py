"""Earth and sky as light: an equirectangular map in target axes, and its averages over the lobes of rough mirrors.

Row 0 is the +z pole; column j looks along azimuth atan2(y, x) = -pi + 2 pi (j + 0.5) / columns.
"""

from dataclasses import dataclass
from functools import cache

import numpy as np
from jaxtyping import Float, Float32, Int32

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.rendering.earth.background import equirectangular

LOBE_ALPHAS = (0.05, 0.15, 0.3, 0.6)
"""GGX widths of the levels; the first is the map itself."""
_COARSE = 16  # rows of the averaged levels


@dataclass(frozen=True, slots=True, eq=False)
class Environment:
    """Radiance from all sides [W/(m^2 sr)]."""

    radiance: Float32[np.ndarray, "rows columns 3"]
    lobes: Float32[np.ndarray, "n_lobes 16 32 3"]
    """Averages over the lobes of `LOBE_ALPHAS[1:]` about each direction."""


def build_environment(radiance: Float32[np.ndarray, "rows columns 3"]) -> Environment:
    """The map with its lobe averages."""
    radiance = np.ascontiguousarray(radiance, np.float32)
    rows = radiance.shape[0]
    if rows % _COARSE:
        raise ValueError(f"an environment map needs a multiple of {_COARSE} rows, found {rows}")
    k = rows // _COARSE
    coarse = radiance.reshape(_COARSE, k, 2 * _COARSE, k, 3).mean(axis=(1, 3)).reshape(-1, 3)
    lobes = np.empty((len(LOBE_ALPHAS) - 1, *coarse.shape), np.float32)
    _average(_lobe_weights(), coarse, lobes)
    return Environment(radiance, lobes.reshape(-1, _COARSE, 2 * _COARSE, 3))


def map_cell(directions: Float[np.ndarray, "n 3"], rows: int) -> Int32[np.ndarray, "n"]:
    """Index of the cell that each unit direction falls into, row-major."""
    row = np.floor(np.arccos(np.clip(directions[:, 2], -1.0, 1.0)) / np.pi * rows).clip(0, rows - 1)
    azimuth = np.arctan2(directions[:, 1], directions[:, 0])
    column = np.floor((azimuth + np.pi) / np.pi * rows).clip(0, 2 * rows - 1)
    return (row * 2 * rows + column).astype(np.int32)


@cache
def _lobe_weights() -> Float32[np.ndarray, "n_lobes cells cells"]:
    """Share of each cell in the average about each direction.

    View and normal are taken along the reflected ray (B. Karis, "Real shading in Unreal Engine 4", SIGGRAPH 2013).
    """
    d = equirectangular(_COARSE).reshape(-1, 3)
    solid = np.repeat(np.sin(np.pi * (np.arange(_COARSE) + 0.5) / _COARSE), 2 * _COARSE)
    cosine = np.clip(d @ d.T, -1.0, 1.0)
    nh2 = 0.5 * (1.0 + cosine)
    levels = []
    for alpha in LOBE_ALPHAS[1:]:
        lobe = np.maximum(cosine, 0.0) / (nh2 * (alpha**2 - 1.0) + 1.0) ** 2 * solid
        levels.append(lobe / lobe.sum(axis=1, keepdims=True))
    return np.array(levels, np.float32)


@ray_kernel
def _average(weights, radiance, out):
    # a plain loop: a threaded matrix product would add in an order that depends on the machine
    for level in range(weights.shape[0]):
        for i in range(weights.shape[1]):
            r, g, b = np.float32(0.0), np.float32(0.0), np.float32(0.0)
            for j in range(weights.shape[2]):
                w = weights[level, i, j]
                r += w * radiance[j, 0]
                g += w * radiance[j, 1]
                b += w * radiance[j, 2]
            out[level, i, 0], out[level, i, 1], out[level, i, 2] = r, g, b


@ray_kernel
def _add_lookup(radiance, d, weight, out):
    """Adds the bilinear value of the map in the unit direction `d`, times `weight`, to `out`."""
    x, y, z = d
    rows, columns = radiance.shape[0], radiance.shape[1]
    v = np.arccos(min(max(z, -1.0), 1.0)) / np.pi * rows - 0.5
    u = (np.arctan2(y, x) + np.pi) / (2.0 * np.pi) * columns - 0.5
    i, j = int(np.floor(v)), int(np.floor(u))
    fv, fu = v - i, u - j
    top, bottom = max(i, 0), min(i + 1, rows - 1)
    left, right = (j + columns) % columns, (j + 1) % columns
    for c in range(3):
        upper = radiance[top, left, c] * (1.0 - fu) + radiance[top, right, c] * fu
        lower = radiance[bottom, left, c] * (1.0 - fu) + radiance[bottom, right, c] * fu
        out[c] += weight * (upper * (1.0 - fv) + lower * fv)


@ray_kernel
def lobe_radiance(radiance, lobes, d, alpha, out):
    """Fills `out` (3) with the radiance about the unit direction `d`, averaged over a lobe of width `alpha`."""
    out[0] = out[1] = out[2] = 0.0
    last = lobes.shape[0]
    level, low = 0, LOBE_ALPHAS[0]
    blend = 0.0
    for k in range(1, last + 1):
        high = LOBE_ALPHAS[k]
        if alpha <= high:
            blend = max(0.0, (alpha - low) / (high - low))
            break
        level, low = k, high
    if level == 0:
        _add_lookup(radiance, d, 1.0 - blend, out)
    else:
        _add_lookup(lobes[level - 1], d, 1.0 - blend, out)
    if blend > 0.0 and level < last:
        _add_lookup(lobes[level], d, blend, out)
