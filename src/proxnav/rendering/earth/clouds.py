"""How much cloud stands over a point: weather at large, fractal detail down to 300 m, and thin high cloud."""

import math
from functools import cache, lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Float32, Int8

from proxnav.geometry.compiled.kernel import fast_inlined_kernel, fast_kernel
from proxnav.rendering.earth import noise
from proxnav.rendering.earth.ellipsoid import A_M
from proxnav.rendering.earth.imagery import read_equirectangular
from proxnav.rendering.earth.weather import COLUMNS, ROWS, weather

PERIODS_M = (1100e3, 140e3, 17e3)
"""m, periods of the three layers of detail; each holds wavelengths from a quarter to a fiftieth of it."""
WEIGHTS = (0.105, 0.075, 0.042)
NONE = 10.0
"""Threshold of a sky without cloud."""
EDGE = 0.12
"""Field above the threshold at which a cloud is opaque."""


class Clouds(NamedTuple):
    """The cloud field of one seed and cover."""

    weather: Float32[np.ndarray, "rows columns"]
    """Moisture, north first, west first."""
    noise: Int8[np.ndarray, "n_noise"]
    """Table of `noise.table`."""
    shift: float
    """Turn of the weather about the pole, in map columns."""
    mirror: bool
    """Whether north and south are exchanged."""
    offsets: Float[np.ndarray, "layer=3 3"]
    """Offsets of the layers of detail, in periods."""
    threshold: float
    """Field value at which cloud begins."""
    pivot: float
    """Moisture at the edge of weather: beyond it the field saturates and detail decides."""
    thin: float
    """Value of the high field at which thin cloud begins."""


@fast_inlined_kernel
def _moisture(clouds, lon, lat, turn):
    column = (lon / (2.0 * math.pi) + 0.5 + turn) * COLUMNS - 0.5 + clouds.shift
    row = (0.5 - lat / math.pi) * ROWS - 0.5
    if clouds.mirror:
        row = ROWS - 1 - row
    i, j = math.floor(row), math.floor(column)
    fy, fx = row - i, column - j
    i0, i1 = min(max(int(i), 0), ROWS - 1), min(max(int(i) + 1, 0), ROWS - 1)
    j0 = int(j) & (COLUMNS - 1)  # COLUMNS is a power of two
    j1 = (j0 + 1) & (COLUMNS - 1)
    image = clouds.weather
    top = (1.0 - fx) * image[i0, j0] + fx * image[i0, j1]
    return (1.0 - fy) * top + fy * ((1.0 - fx) * image[i1, j0] + fx * image[i1, j1])


@fast_inlined_kernel
def fade(footprint_m, period):
    """Weight of a layer of detail for rays as wide as `footprint_m`: what is finer than a ray must not alias."""
    return min(1.0, max(0.0, 1.0 - (footprint_m - 0.025 * period) / (0.10 * period)))


@fast_inlined_kernel
def large(clouds, x, y, z, lon, lat, footprint_m):
    """(field, heap, warp): weather and the first layer of detail above a point of the unit sphere.

    heap in [0, 1] says how much the detail is heaps rather than sheets; warp bends the finer layers.
    """
    moisture = _moisture(clouds, lon, lat, 0.0)
    above = moisture - clouds.pivot
    heap = min(1.0, max(0.0, 0.45 - 2.0 * above))
    moisture = clouds.pivot + (0.16 * math.tanh(above / 0.16) if above > 0.0 else 0.30 * math.tanh(above / 0.30))
    weight = fade(footprint_m, PERIODS_M[0])
    if weight <= 0.0:
        return moisture, heap, 0.0
    # Alone, its bumps look like blobs: it gives way with the finer layers.
    weight *= 0.35 + 0.65 * fade(footprint_m, PERIODS_M[1])
    s = A_M / PERIODS_M[0]
    o = clouds.offsets
    a, b = noise.sample(clouds.noise, x * s + o[0, 0], y * s + o[0, 1], z * s + o[0, 2])
    return moisture + WEIGHTS[0] * weight * ((1.0 - 0.2 * heap) * a + 0.25 * heap * b), heap, a


@fast_inlined_kernel
def fine(clouds, layer, x, y, z, heap, warp):
    """Detail of the second (1) or third (2) layer, of unit size."""
    s = A_M / PERIODS_M[layer]
    o = clouds.offsets
    bend = 0.05 * warp
    a, b = noise.sample(
        clouds.noise, x * s + o[layer, 0] + bend, y * s + o[layer, 1] - bend, z * s + o[layer, 2] + bend
    )
    return (1.0 - heap) * a + heap * (0.4 * a + 0.8 * b)


@fast_inlined_kernel
def field(clouds, x, y, z, lon, lat, footprint_m):
    """The whole field: cloud where it exceeds the threshold."""
    value, heap, warp = large(clouds, x, y, z, lon, lat, footprint_m)
    for layer in range(1, 3):
        weight = fade(footprint_m, PERIODS_M[layer])
        if weight > 0.0:
            value += WEIGHTS[layer] * weight * fine(clouds, layer, x, y, z, heap, warp)
    return value


@fast_inlined_kernel
def opacity(clouds, value, slant):
    """Share of light that a cloud of this field value keeps from what lies below, seen at `slant` times its depth."""
    x = (value - clouds.threshold) / EDGE
    return 0.0 if x <= 0.0 else 1.0 - math.exp(-slant * x * (1.6 + 1.5 * x))


@fast_inlined_kernel
def cirrus(clouds, x, y, z, lon, lat, footprint_m):
    """Opacity of thin high cloud, drawn out along its own weather."""
    value = _moisture(clouds, lon, lat, 0.37) - clouds.thin
    if value <= -0.25:
        return 0.0
    weight = fade(footprint_m, 400e3)
    if weight > 0.0:
        o = clouds.offsets
        a, _ = noise.sample(clouds.noise, x * 9.0 + o[1, 0], y * 9.0 + o[2, 0], z * 26.0 + 0.8 * value)
        value += 0.12 * weight * a
    return min(0.45, 0.9 * max(0.0, value))


@fast_kernel
def _field_at(clouds, points, out):
    for i in range(len(points)):
        x, y, z = points[i, 0], points[i, 1], points[i, 2]
        out[i] = field(clouds, x, y, z, math.atan2(y, x), math.asin(z), 300.0)


@lru_cache(maxsize=64)
def clouds(cover: float, seed: int, image: str = "") -> Clouds:
    """The field whose mean cover is `cover`; every seed is other weather. Of an image the seed draws the detail."""
    rng = np.random.default_rng([seed, 20])
    shift, mirror, offsets = rng.uniform(0, COLUMNS), bool(rng.integers(2)), rng.random((3, 3))
    if image:
        return Clouds(weather_of_image(image), noise.table(), 0.0, False, offsets, IMAGE_EDGE, IMAGE_PIVOT, NONE)
    cover = min(1.0, cover)
    threshold = NONE if cover <= 0.0 else float(np.interp(cover, *_thresholds()))
    return Clouds(weather(), noise.table(), float(shift), mirror, offsets, threshold, 1.0 - cover, 1.0 - 0.6 * cover)


IMAGE_EDGE, IMAGE_PIVOT = 0.50, 0.58
"""Threshold and pivot of cloud that comes from an image."""


@lru_cache(maxsize=2)
def weather_of_image(path: str) -> Float32[np.ndarray, "rows columns"]:
    """The moisture map whose cloud, before detail, is as opaque as a picture is white."""
    import cv2

    white = read_equirectangular(Path(path)).mean(axis=-1, dtype=np.float32) / 255.0
    white = cv2.resize(white, (COLUMNS, ROWS), interpolation=cv2.INTER_AREA)
    x = (np.sqrt(1.6**2 - 6.0 * np.log(1.0 - 0.95 * white)) - 1.6) / 3.0  # `opacity` solved for the field
    firm = 0.12 * np.clip(white / 0.1 - 9.0, 0.0, 1.0)  # so far from the threshold that detail neither tears white
    clear = 0.22 * np.clip(1.0 - white / 0.05, 0.0, 1.0)  # nor covers black
    above = IMAGE_EDGE - IMAGE_PIVOT + EDGE * x + firm - clear
    # what `large` saturates is stretched beforehand
    wet, dry = 0.16 * np.arctanh(np.clip(above / 0.16, 0.0, 0.99)), 0.30 * np.arctanh(np.clip(above / 0.30, -0.99, 0.0))
    return (IMAGE_PIVOT + wet + dry).astype(np.float32)


@cache
def _thresholds() -> tuple[Float[np.ndarray, "n"], Float[np.ndarray, "n"]]:
    """Covers and the thresholds that give them: quantiles of the field over points spread evenly on the sphere."""
    i = np.arange(8_000) + 0.5
    z = 1.0 - 2.0 * i / len(i)
    turn = np.pi * (1.0 + np.sqrt(5.0)) * i
    ring = np.sqrt(1.0 - z * z)
    points = np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=-1)
    covers, values, out = np.linspace(0.0, 1.0, 21), np.empty(21), np.empty(len(i))
    offsets = np.zeros((3, 3))
    for k, cover in enumerate(covers):
        probe = Clouds(weather(), noise.table(), 0.0, False, offsets, NONE, 1.0 - cover, NONE)
        _field_at(probe, points, out)
        values[k] = np.quantile(out, 1.0 - cover)
    # The lightest quarter of a cloud's edge lets through most light and does not look like cloud.
    return covers, values - 0.25 * EDGE
