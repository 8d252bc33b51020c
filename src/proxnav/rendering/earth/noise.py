"""Periodic noise in three dimensions, kept as a table: fractal detail for clouds and ground at the cost of a lookup.

Three dimensions because a sphere cut out of a solid has no seams and no poles. One period holds four octaves.
"""

import math
from functools import cache

import numpy as np
from jaxtyping import Float, Float32, Int8
from scipy.spatial import KDTree

from proxnav.geometry.compiled.kernel import fast_kernel, fast_pasted_kernel
from proxnav.rendering.earth.stored import stored

SIZE = 128
CHANNELS = 2
"""0: fractal gradient-like noise; 1: cells, bright in the middle and dark at their borders, in three octaves."""


_SEED = 7
_BRICK = 4
_BRICKS = SIZE // _BRICK
STEP = 3.5 / 127.0
"""Value of one unit of the table."""
Cube = Float[np.ndarray, "size size size"]


@cache
def table() -> Int8[np.ndarray, "n_noise"]:
    """SIZE^3 CHANNELS values of noise of mean 0 and standard deviation 1, with period 1, in units of `STEP`.

    Bricks of 4 x 4 x 4 nodes lie together and small: a sample touches two lines of the processor's cache instead of
    four, and most of the table stays in it.
    """
    return stored("noise-2", _bricked)


def _bricked() -> Int8[np.ndarray, "n_noise"]:
    units = np.round(_make() / STEP).astype(np.int8)
    bricks = units.reshape(_BRICKS, _BRICK, _BRICKS, _BRICK, _BRICKS, _BRICK, CHANNELS)
    return np.ascontiguousarray(bricks.transpose(0, 2, 4, 1, 3, 5, 6)).reshape(-1)


@cache
def fractal() -> Float32[np.ndarray, "size size size"]:
    """The first channel node by node, before it is packed."""
    return _fractal(np.random.default_rng(_SEED)).astype(np.float32)


def _make() -> Float32[np.ndarray, "size size size channel=2"]:
    rng = np.random.default_rng(_SEED)
    return np.stack([_fractal(rng), _cells(rng)], axis=-1).astype(np.float32)


def _standard(field: Cube) -> Cube:
    return np.clip((field - field.mean()) / field.std(), -3.5, 3.5)


def _fractal(rng: np.random.Generator) -> Cube:
    """Gaussian field with a power law spectrum between 4 and 48 cycles per period, like turbulence (slope -5/3)."""
    k = np.fft.fftfreq(SIZE, 1.0 / SIZE)
    kx, ky, kz = np.meshgrid(k, k, k[: SIZE // 2 + 1], indexing="ij")
    kk = np.sqrt(kx**2 + ky**2 + np.abs(kz) ** 2)
    band = (kk >= 3.5) & (kk <= 48)
    amplitude = np.where(band, np.maximum(kk, 1.0) ** (-(5.0 / 3.0 + 2.0) / 2.0), 0.0)
    white = np.fft.rfftn(rng.normal(size=(SIZE, SIZE, SIZE)))
    return _standard(np.fft.irfftn(white * amplitude, s=(SIZE, SIZE, SIZE), axes=(0, 1, 2)))


def _cells(rng: np.random.Generator) -> Cube:
    """Distances to scattered points, turned upside down and summed over octaves: billows."""
    axis = (np.arange(SIZE) + 0.5) / SIZE
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    total = np.zeros(len(points))
    for cells, weight in ((6, 1.0), (12, 0.55), (24, 0.3)):
        seeds = rng.random((cells**3, 3))
        distance, _ = KDTree(seeds, boxsize=1.0).query(points, k=1, workers=1)
        total -= weight * distance * cells
    return _standard(total.reshape(SIZE, SIZE, SIZE))


_LINE, _SIDE, _NODES = CHANNELS * _BRICK**3, CHANNELS * _BRICK**3 * _BRICKS, CHANNELS * _BRICK**3 * _BRICKS**2


@fast_kernel
def sample(noise, x, y, z):
    """Both channels at a point of the unit period, trilinear."""
    x, y, z = x * SIZE, y * SIZE, z * SIZE
    fi, fj, fk = math.floor(x), math.floor(y), math.floor(z)
    fx, fy, fz = x - fi, y - fj, z - fk
    i, j, k = int(fi), int(fj), int(fk)
    i0, i1 = _place(i, _NODES, 32), _place(i + 1, _NODES, 32)
    j0, j1 = _place(j, _SIDE, 8), _place(j + 1, _SIDE, 8)
    k0, k1 = _place(k, _LINE, 2), _place(k + 1, _LINE, 2)
    gx, gy, gz = 1.0 - fx, 1.0 - fy, 1.0 - fz
    w = (gx * gy * STEP, gx * fy * STEP, fx * gy * STEP, fx * fy * STEP)
    rows = (i0 + j0, i0 + j1, i1 + j0, i1 + j1)
    a = gz * _four(noise, rows, k0, w) + fz * _four(noise, rows, k1, w)
    b = gz * _four(noise, rows, k0 + 1, w) + fz * _four(noise, rows, k1 + 1, w)
    return a, b


@fast_pasted_kernel
def _place(i, brick, node):
    """Share of a node's index in the table that one of its coordinates has."""
    i = i & (SIZE - 1)
    return (i >> 2) * brick + (i & 3) * node


@fast_pasted_kernel
def _four(n, rows, k, w):
    return w[0] * n[rows[0] + k] + w[1] * n[rows[1] + k] + w[2] * n[rows[2] + k] + w[3] * n[rows[3] + k]
