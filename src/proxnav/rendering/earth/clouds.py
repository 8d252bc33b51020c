"""How much cloud stands over a point: weather at large, fractal detail from 200 km down to 300 m."""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numba import njit

from proxnav.rendering.earth import noise
from proxnav.rendering.earth.ellipsoid import A_M
from proxnav.rendering.earth.weather import COLUMNS, ROWS, weather

PERIODS_M = (1100e3, 130e3, 15e3)
"""m, periods of the three layers of detail; each holds wavelengths from a quarter to a fiftieth of it."""
WEIGHTS = (0.115, 0.085, 0.050)
SOFTNESS = 0.22
"""Width of the edge of a cloud in units of the field."""


class Clouds(NamedTuple):
    """The cloud field of one seed and cover."""

    weather: np.ndarray
    noise: np.ndarray
    shift: float
    """Turn of the weather about the pole, in map columns."""
    mirror: bool
    """Whether north and south are exchanged."""
    offsets: np.ndarray
    """(3, 3) of the layers of detail, in periods."""
    threshold: float
    """Field value at which cloud begins; above 9 there is none."""


@njit(cache=True, nogil=True)
def _bilinear(image, column, row):
    i = math.floor(row)
    j = math.floor(column)
    fy, fx = row - i, column - j
    i0, i1 = min(max(int(i), 0), ROWS - 1), min(max(int(i) + 1, 0), ROWS - 1)
    j0, j1 = int(j) % COLUMNS, (int(j) + 1) % COLUMNS
    top = (1.0 - fx) * image[i0, j0] + fx * image[i0, j1]
    return (1.0 - fy) * top + fy * ((1.0 - fx) * image[i1, j0] + fx * image[i1, j1])


@njit(cache=True, nogil=True)
def field(clouds, x, y, z, lon, lat, footprint_m):
    """Cloudiness above a point of the unit sphere (x, y, z): cloud where it exceeds the threshold.

    Detail finer than `footprint_m` fades out, so that it does not alias.
    """
    column = (lon / (2.0 * math.pi) + 0.5) * COLUMNS - 0.5 + clouds.shift
    row = (0.5 - lat / math.pi) * ROWS - 0.5
    if clouds.mirror:
        row = ROWS - 1 - row
    moisture = _bilinear(clouds.weather, column, row)
    value = moisture
    warp = 0.0
    for layer in range(3):
        period = PERIODS_M[layer]
        fade = 1.0 - (footprint_m - 0.02 * period) / (0.10 * period)
        if fade <= 0.0:
            break
        scale = A_M / period
        o = clouds.offsets[layer]
        bend = 0.035 * warp
        a, b = noise.sample(clouds.noise, x * scale + o[0] + bend, y * scale + o[1] - bend, z * scale + o[2] + bend)
        # Smooth decks where it is moist, heaps where it is dry.
        heap = min(1.0, max(0.0, 1.35 - 1.2 * moisture))
        warp = a
        value += WEIGHTS[layer] * min(1.0, fade) * ((1.0 - heap) * a + heap * (0.45 * a + 0.75 * b))
    return value


@njit(cache=True, nogil=True, inline="always")
def density(clouds, value):
    """Density in [0, 1] of a field value."""
    x = (value - clouds.threshold) / SOFTNESS
    return min(1.0, max(0.0, x))


@njit(cache=True, nogil=True)
def _field_at(clouds, points, out):
    for i in range(len(points)):
        x, y, z = points[i]
        out[i] = field(clouds, x, y, z, math.atan2(y, x), math.asin(z), 300.0)


@cache
def clouds(cover: float, seed: int) -> Clouds:
    """The field whose mean cover is `cover`; every seed is other weather."""
    rng = np.random.default_rng([seed, 20])
    shift, mirror, offsets = rng.uniform(0, COLUMNS), bool(rng.integers(2)), rng.random((3, 3))
    bare = Clouds(weather(), noise.table(), float(shift), mirror, offsets, 10.0)
    return bare if cover <= 0.0 else bare._replace(threshold=_threshold(bare, cover))


def _threshold(bare: Clouds, cover: float) -> float:
    """Quantile of the field over points spread evenly on the sphere; half the edge counts as cloud."""
    i = np.arange(20_000) + 0.5
    z = 1.0 - 2.0 * i / len(i)
    turn = np.pi * (1.0 + np.sqrt(5.0)) * i
    ring = np.sqrt(1.0 - z * z)
    out = np.empty(len(i))
    _field_at(bare, np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=-1), out)
    return float(np.quantile(out, max(0.0, 1.0 - cover))) - 0.35 * SOFTNESS
