"""The patterns of spacecraft surfaces, one function for each kind of material; sizes are typical of flown hardware."""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Float32

from proxnav.targets.surface.material import MaterialKind
from proxnav.targets.surface.patterns.pattern import (
    Pattern,
    cell_index,
    edge_distance,
    normals_of_height,
    periodic_noise,
)

SIZE = 256
"""Texels along the side of a patterned tile."""


@lru_cache(maxsize=16)
def nominal_pattern(kind: MaterialKind) -> Pattern:
    """The pattern of a kind of material, the same on every spacecraft; callers must not write to its arrays."""
    return _PATTERNS[kind]()


def _tile() -> Pattern:
    """Ceramic tiles of 150 mm with dark 5 mm gaps; each tile has its own tone, each row is shifted by half a tile."""
    n, tile_m = 8, 1.2
    v, u = np.meshgrid((np.arange(SIZE) + 0.5) / SIZE * n, (np.arange(SIZE) + 0.5) / SIZE * n, indexing="ij")
    u = (u + 0.5 * (v.astype(int) % 2)) % n
    cell, pitch = v.astype(int) * n + u.astype(int), tile_m / n
    border = np.minimum(edge_distance(v % 1.0, pitch), edge_distance(u % 1.0, pitch))
    rng = np.random.default_rng(11)
    tone = 1.0 + 0.16 * rng.uniform(-1, 1, n * n)[cell] + 0.04 * periodic_noise(SIZE, 1.0, 12)
    gap = _smooth_step(0.0045 - border, 0.003)
    height = -0.0015 * _smooth_step(0.008 - border, 0.008)
    return _pattern(tile_m, tone, gap, (0.01, 0.01, 0.01), 0.0, 0.9, 1.0 + 0.15 * (tone - 1.0) / 0.16, height)


def _insulation() -> Pattern:
    """Flexible white blankets of 0.5 m, quilted every 31 mm, with stitched seams and handling stains."""
    tile_m, blankets, quilts = 1.0, 2, 32
    cell, bi, bj = cell_index(SIZE, blankets, blankets)
    seam = np.minimum(edge_distance(bi, tile_m / blankets), edge_distance(bj, tile_m / blankets))
    _, qi, qj = cell_index(SIZE, quilts, quilts)
    pillow = np.sin(np.pi * qi) * np.sin(np.pi * qj)
    rng = np.random.default_rng(21)
    stains = 0.05 * rng.uniform(-1, 1, blankets**2)[cell] + 0.04 * periodic_noise(SIZE, 2.0, 22)
    tone = 1.0 + stains + 0.06 * (pillow - 0.4)
    line = _smooth_step(0.006 - seam, 0.004)
    height = 0.0012 * pillow + 0.002 * periodic_noise(SIZE, 4.5, 23, low=2) - 0.002 * _smooth_step(0.012 - seam, 0.01)
    return _pattern(tile_m, tone, line * 0.8, (0.30, 0.29, 0.27), 0.0, 0.9, np.ones_like(tone), height)


def _foil() -> Pattern:
    """Multilayer insulation: sharp creases between nearly flat facets, tape every half metre."""
    tile_m = 1.0
    crease = sum(
        (np.abs(periodic_noise(SIZE, 6.0, 31 + k, low=low)) * amount for k, (low, amount) in enumerate(_CREASES)),
        np.zeros((SIZE, SIZE), np.float32),
    )
    _, ti, tj = cell_index(SIZE, 2, 2)
    tape_distance = np.minimum(edge_distance(ti, 0.5), edge_distance(tj, 0.5))
    tape = _smooth_step(0.014 - tape_distance, 0.004)
    tone = 1.0 + 0.05 * periodic_noise(SIZE, 1.6, 37) - 0.10 * _smooth_step(0.15 - crease / 0.004, 0.15)
    roughness = 1.0 + 0.2 * periodic_noise(SIZE, 2.0, 38)
    return _pattern(tile_m, tone, tape * 0.6, (0.80, 0.70, 0.45), 1.0, 0.45, np.clip(roughness, 0.5, 1.6), crease)


_CREASES = ((3, 0.0080), (8, 0.0022), (18, 0.0006))
"""Lowest cycles per metre and height [m] of each generation of creases."""


def _solar_cell() -> Pattern:
    """Cells of 80 x 40 mm with cropped corners under cover glass: bus bar, gaps showing the substrate."""
    tile_m, rows, columns = 0.64, 16, 8
    cell, ci, cj = cell_index(SIZE, rows, columns)
    height, width = tile_m / rows, tile_m / columns
    across, along = edge_distance(ci, height), edge_distance(cj, width)
    gap = _smooth_step(0.0006 - np.minimum(across, along), 0.0030)
    gap = np.maximum(gap, _smooth_step(0.009 - across - along, 0.0030))
    bus = 0.4 * _smooth_step(0.0010 - np.abs(ci - 0.08) * height, 0.0025)
    rng = np.random.default_rng(41)
    tone = 1.0 + 0.15 * rng.uniform(-1, 1, rows * columns)[cell]
    tilt = 0.0006 * (rng.uniform(-1, 1, rows * columns)[cell] * (ci - 0.5) * height / 0.04)
    glass = np.where(gap > 0.5, 4.0, 1.0) * np.ones_like(tone)
    return _pattern(tile_m, tone, np.maximum(gap, bus), (0.34, 0.31, 0.26), 0.0, 0.5, glass, tilt)


def _radiator() -> Pattern:
    """Optical solar reflectors: 40 mm mirrors in strips between white joints."""
    tile_m, n = 0.8, 20
    cell, ci, cj = cell_index(SIZE, n, n)
    border = np.minimum(edge_distance(ci, tile_m / n), edge_distance(cj, tile_m / n))
    rng = np.random.default_rng(51)
    strip = (np.arange(n * n) // n % 4 == 0)[cell]
    mirror = np.where(strip, 0.0, _smooth_step(border - 0.002, 0.002))
    tone = 1.0 + 0.03 * rng.uniform(-1, 1, n * n)[cell]
    return _pattern(tile_m, tone, mirror * 0.7, (0.88, 0.88, 0.90), 1.0, 0.12, np.where(strip, 4.0, 1.5), None)


def _metal() -> Pattern:
    """Machined metal: faint lines along u, blotches of oxide."""
    size = 128
    lines = np.random.default_rng(61).standard_normal(size).astype(np.float32)[:, None]
    tone = 1.0 + 0.02 * lines + 0.04 * periodic_noise(size, 2.0, 62)
    roughness = np.clip(1.0 + 0.12 * periodic_noise(size, 2.0, 63), 0.6, 1.5)
    return _pattern(0.5, tone, np.zeros((size, size)), (0.0, 0.0, 0.0), 0.0, 0.5, roughness, None)


def _plain() -> Pattern:
    """Paint or composite: a few per cent of unevenness."""
    tone = 1.0 + 0.03 * periodic_noise(64, 1.5, 71)
    return _pattern(0.6, tone, np.zeros((64, 64)), (0.0, 0.0, 0.0), 0.0, 0.5, np.ones((64, 64)), None)


def _smooth_step(x: Float[np.ndarray, "h w"], width: float) -> Float[np.ndarray, "h w"]:
    """0 below -width/2, 1 above width/2, a line between: an edge as wide as a texel does not flicker."""
    return np.clip(x / width + 0.5, 0.0, 1.0)


def _read_only(values: Float[np.ndarray, "*texels"]) -> Float32[np.ndarray, "*texels"]:
    """The values as read-only float32."""
    values = np.ascontiguousarray(values, dtype=np.float32)
    values.setflags(write=False)
    return values


def _pattern(
    tile_m: float,
    tone: Float[np.ndarray, "h w"],
    accent: Float[np.ndarray, "h w"],
    accent_albedo: tuple[float, float, float],
    accent_metallic: float,
    accent_roughness: float,
    roughness: Float[np.ndarray, "h w"],
    height_m: Float[np.ndarray, "h w"] | None,
) -> Pattern:
    normal = None if height_m is None else _read_only(normals_of_height(np.asarray(height_m, np.float64), tile_m))
    fields = _read_only(tone), _read_only(accent)
    accents = accent_albedo, accent_metallic, accent_roughness
    return Pattern(tile_m, *fields, *accents, _read_only(roughness), normal)


_PATTERNS = {
    "tile": _tile,
    "insulation": _insulation,
    "foil": _foil,
    "solar_cell": _solar_cell,
    "radiator": _radiator,
    "metal": _metal,
    "plain": _plain,
}
