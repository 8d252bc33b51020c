"""Periodic noise in three dimensions, kept as a table: fractal detail for clouds and ground at the cost of a lookup.

Three dimensions because a sphere cut out of a solid has no seams and no poles. One period holds four octaves.
"""

import math
from functools import cache

import numpy as np
from scipy.spatial import KDTree

from proxnav.rendering.earth.kernel import kernel
from proxnav.rendering.earth.stored import stored

SIZE = 128
CHANNELS = 2
"""0: fractal gradient-like noise; 1: cells, bright in the middle and dark at their borders, in three octaves."""


@cache
def table() -> np.ndarray:
    """(SIZE, SIZE, SIZE, CHANNELS) float32 noise of mean 0 and standard deviation 1, with period 1."""
    return stored("noise-1", _make)


def _make() -> np.ndarray:
    rng = np.random.default_rng(7)
    return np.stack([_fractal(rng), _cells(rng)], axis=-1).astype(np.float32)


def _standard(field: np.ndarray) -> np.ndarray:
    return np.clip((field - field.mean()) / field.std(), -3.5, 3.5)


def _fractal(rng: np.random.Generator) -> np.ndarray:
    """Gaussian field with a power law spectrum between 4 and 48 cycles per period, like turbulence (slope -5/3)."""
    k = np.fft.fftfreq(SIZE, 1.0 / SIZE)
    kx, ky, kz = np.meshgrid(k, k, k[: SIZE // 2 + 1], indexing="ij")
    kk = np.sqrt(kx**2 + ky**2 + np.abs(kz) ** 2)
    band = (kk >= 3.5) & (kk <= 48)
    amplitude = np.where(band, np.maximum(kk, 1.0) ** (-(5.0 / 3.0 + 2.0) / 2.0), 0.0)
    white = np.fft.rfftn(rng.normal(size=(SIZE, SIZE, SIZE)))
    return _standard(np.fft.irfftn(white * amplitude, s=(SIZE, SIZE, SIZE), axes=(0, 1, 2)))


def _cells(rng: np.random.Generator) -> np.ndarray:
    """Distances to scattered points, turned upside down and summed over octaves: billows."""
    axis = (np.arange(SIZE) + 0.5) / SIZE
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    total = np.zeros(len(points))
    for cells, weight in ((6, 1.0), (12, 0.55), (24, 0.3)):
        seeds = rng.random((cells**3, 3))
        distance, _ = KDTree(seeds, boxsize=1.0).query(points, k=1, workers=1)
        total -= weight * distance * cells
    return _standard(total.reshape(SIZE, SIZE, SIZE))


@kernel()
def sample(noise, x, y, z):
    """Both channels at a point of the unit period, trilinear."""
    x, y, z = x * SIZE, y * SIZE, z * SIZE
    i, j, k = math.floor(x), math.floor(y), math.floor(z)
    fx, fy, fz = x - i, y - j, z - k
    mask = SIZE - 1
    i0, j0, k0 = int(i) & mask, int(j) & mask, int(k) & mask
    i1, j1, k1 = (i0 + 1) & mask, (j0 + 1) & mask, (k0 + 1) & mask
    gx, gy, gz = 1.0 - fx, 1.0 - fy, 1.0 - fz
    w00, w01, w10, w11 = gx * gy, gx * fy, fx * gy, fx * fy
    w = (w00, w01, w10, w11)
    a = gz * _four(noise, i0, i1, j0, j1, k0, 0, w) + fz * _four(noise, i0, i1, j0, j1, k1, 0, w)
    b = gz * _four(noise, i0, i1, j0, j1, k0, 1, w) + fz * _four(noise, i0, i1, j0, j1, k1, 1, w)
    return a, b


@kernel(inline="always")
def _four(n, i0, i1, j0, j1, k, c, w):
    return w[0] * n[i0, j0, k, c] + w[1] * n[i0, j1, k, c] + w[2] * n[i1, j0, k, c] + w[3] * n[i1, j1, k, c]
