"""From a part's surface to the levels of its texels, row by row in planes, so that the processor's wide registers help.

A patterned surface is worked out here, in the arithmetic of `targets/textures.py` and with the same bits, and never
stored whole: a new look of the target costs little more than reading its patterns.
"""

from functools import lru_cache
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Float32, Int32

from proxnav.geometry.compiled.kernel import ray_kernel
from proxnav.targets.surface.patterns.pattern import Pattern
from proxnav.targets.surface.textures import BRIGHTEST, SMOOTHEST, PartTexture, PatternedTexture

MATT, METALLIC, METAL, ALPHA, SLOPE_U, SLOPE_V, MOMENT, PLANES = 0, 3, 4, 7, 8, 9, 10, 11
"""Places in a texel: colour of the matt share (3), metallic, colour of the metal share (3), width of the GGX lobe,
slopes along u and along v, half of the slopes' second moment; and the number of places in use."""
CHANNELS = 12
"""Length of a texel."""

Surface = PartTexture | PatternedTexture


def surface_size(surface: Surface) -> tuple[int, int]:
    """(rows, columns) of the finest texels."""
    h, w = surface.pattern.tone.shape if isinstance(surface, PatternedTexture) else surface.metallic.shape
    return h, w


def fill_levels(
    surface: Surface, skip: int, sizes: Int32[np.ndarray, "levels 2"], texels: Float32[np.ndarray, "n 12"]
) -> None:
    """Writes the levels from `skip` on, each a halving of the one before, of (rows, columns) as `sizes` says."""
    h, w = surface_size(surface)
    half = max(1, h // 2) * max(1, w // 2)
    scratch = np.empty((2, PLANES, half), np.float32)
    if isinstance(surface, PatternedTexture):
        p = surface.pattern
        planes = p.tone, p.accent, p.roughness, _pattern_slopes(p)
        _fill_patterned(*planes, _paint(surface), skip, scratch, sizes, texels)
    else:
        planes = surface.albedo, surface.metallic, surface.roughness, _slopes(surface.normal, (h, w))
        _fill_painted(*planes, skip, scratch, sizes, texels)


class _Paint(NamedTuple):
    """What a patterned surface does with its pattern, in float32."""

    base: Float32[np.ndarray, "rgb=3"]
    accent: Float32[np.ndarray, "rgb=3"]
    contrast: np.float32
    share: np.float32
    metallic: np.float32
    metallic_step: np.float32
    roughness: np.float32
    accent_roughness: np.float32


def _paint(surface: PatternedTexture) -> _Paint:
    colours = np.array([surface.base, surface.accent_albedo], np.float32)
    numbers = (
        surface.contrast, surface.share, surface.metallic, surface.metallic_step, surface.roughness,
        surface.accent_roughness,
    )  # fmt: skip
    return _Paint(*colours, *map(np.float32, numbers))


@lru_cache(maxsize=16)
def _pattern_slopes(pattern: Pattern) -> Float32[np.ndarray, "2 h w"]:
    return _slopes(pattern.normal, pattern.tone.shape)


def _slopes(
    normal: Float32[np.ndarray, "_rows _columns 3"] | None, shape: tuple[int, ...]
) -> Float32[np.ndarray, "2 h w"]:
    """Slopes along u and along v; no rows and columns for a flat surface."""
    if normal is None:
        return np.zeros((2, 0, 0), np.float32)
    slope = normal[..., :2] / np.maximum(normal[..., 2:], np.float32(0.1))
    if slope.shape[:2] != shape:
        slope = cv2.resize(slope, shape[::-1], interpolation=cv2.INTER_AREA)
    return np.ascontiguousarray(np.moveaxis(slope, -1, 0))


_ONE, _HALF, _QUARTER, _ZERO = np.float32(1.0), np.float32(0.5), np.float32(0.25), np.float32(0.0)


@ray_kernel
def _finish_row(slope, y, out):
    """Planes that follow from albedo (in place of MATT), metallic and roughness (in place of ALPHA)."""
    w = out.shape[1]
    for x in range(w):
        m, r = out[METALLIC, x], out[ALPHA, x]
        matt = _ONE - m
        for c in range(3):
            albedo = out[MATT + c, x]
            out[METAL + c, x], out[MATT + c, x] = m * albedo, matt * albedo
        out[ALPHA, x] = r * r
    if slope.shape[1] == 0:
        out[SLOPE_U:PLANES] = _ZERO
        return
    u, v = slope[0, y], slope[1, y]
    for x in range(w):
        out[SLOPE_U, x], out[SLOPE_V, x], out[MOMENT, x] = u[x], v[x], _HALF * (u[x] * u[x] + v[x] * v[x])


@ray_kernel
def _patterned_row(tone, accent, rough, slope, paint, y, out):
    """Fills the planes (PLANES, w) of one row of a patterned surface, as `PatternedTexture.painted` works it out."""
    t, a, q = tone[y], accent[y], rough[y]
    for x in range(out.shape[1]):
        shade, share = _ONE + paint.contrast * (t[x] - _ONE), a[x] * paint.share
        for c in range(3):
            body = shade * paint.base[c]
            out[MATT + c, x] = min(max(body + share * (paint.accent[c] - body), _ZERO), BRIGHTEST)
        out[METALLIC, x] = min(max(paint.metallic + share * paint.metallic_step, _ZERO), _ONE)
        own = q[x] * paint.roughness
        out[ALPHA, x] = min(max(own + share * (paint.accent_roughness - own), SMOOTHEST), _ONE)
    _finish_row(slope, y, out)


@ray_kernel
def _painted_row(albedo, metallic, roughness, slope, y, out):
    """Fills the planes (PLANES, w) of one row of a painted surface."""
    for x in range(out.shape[1]):
        for c in range(3):
            out[MATT + c, x] = albedo[y, x, c]
        out[METALLIC, x], out[ALPHA, x] = metallic[y, x], roughness[y, x]
    _finish_row(slope, y, out)


@ray_kernel
def _halve_rows(top, bottom, out):
    """Means of 2 x 2 texels of two rows of w, a power of two as our textures have; of 2 where they are one wide."""
    w = top.shape[1]
    for c in range(PLANES):
        a, b = top[c], bottom[c]
        if w == 1:
            out[c, 0] = _QUARTER * ((a[0] + a[0]) + (b[0] + b[0]))
        for x in range(w // 2):
            out[c, x] = _QUARTER * ((a[2 * x] + a[2 * x + 1]) + (b[2 * x] + b[2 * x + 1]))


@ray_kernel
def _store(planes, texels):
    """Planes (PLANES, n) into texels (n, CHANNELS)."""
    for i in range(planes.shape[1]):
        for c in range(PLANES):
            texels[i, c] = planes[c, i]
        texels[i, PLANES] = _ZERO


@ray_kernel
def _coarser(scratch, skip, h, w, sizes, texels):
    """The levels from the second on, which `scratch[0]` holds on entry; the first has `h` rows and `w` columns."""
    first = h * w if skip == 0 else 0
    level, now = 1, 0
    h, w = max(1, h // 2), max(1, w // 2)
    for _ in range(skip + sizes.shape[0] - 1):
        if level >= skip:
            _store(scratch[now][:, : h * w], texels[first : first + h * w])
            first += h * w
        h2, w2 = max(1, h // 2), max(1, w // 2)
        for y in range(h2):
            top, bottom = min(2 * y, h - 1), min(2 * y + 1, h - 1)
            _halve_rows(
                scratch[now][:, top * w : (top + 1) * w], scratch[now][:, bottom * w : (bottom + 1) * w],
                scratch[1 - now][:, y * w2 : (y + 1) * w2],
            )  # fmt: skip
        level, now, h, w = level + 1, 1 - now, h2, w2


@ray_kernel
def _pair(rows, y, h, w, skip, scratch, texels):
    """Two finished rows into the first level, if it is kept, and their halving into the second."""
    if skip == 0:
        _store(rows[0], texels[y * w : (y + 1) * w])
        if h > 1:
            _store(rows[1], texels[(y + 1) * w : (y + 2) * w])
    half = max(1, w // 2)
    _halve_rows(rows[0], rows[1], scratch[0][:, (y // 2) * half : (y // 2 + 1) * half])


@ray_kernel
def _fill_patterned(tone, accent, rough, slope, paint, skip, scratch, sizes, texels):
    h, w = tone.shape
    rows = np.empty((2, PLANES, w), np.float32)
    for y in range(0, h, 2):
        for k in range(2):
            _patterned_row(tone, accent, rough, slope, paint, min(y + k, h - 1), rows[k])
        _pair(rows, y, h, w, skip, scratch, texels)
    _coarser(scratch, skip, h, w, sizes, texels)


@ray_kernel
def _fill_painted(albedo, metallic, roughness, slope, skip, scratch, sizes, texels):
    h, w = metallic.shape
    rows = np.empty((2, PLANES, w), np.float32)
    for y in range(0, h, 2):
        for k in range(2):
            _painted_row(albedo, metallic, roughness, slope, min(y + k, h - 1), rows[k])
        _pair(rows, y, h, w, skip, scratch, texels)
    _coarser(scratch, skip, h, w, sizes, texels)
