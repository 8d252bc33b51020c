"""A bank of periodic fields from which random textures are mixed: noise, blotches, stripes, checks, cells."""

from functools import lru_cache

import numpy as np
from jaxtyping import Float, Float32
from scipy.spatial import KDTree

from proxnav.targets.surface.patterns.pattern import periodic_noise

SIZE = 128


@lru_cache(maxsize=1)
def field_bank() -> Float32[np.ndarray, "n 128 128"]:
    """Fields of zero mean and largest magnitude 1; read-only."""
    x = (np.arange(SIZE) + 0.5) / SIZE
    u, v = np.meshgrid(x, x)
    fields = [periodic_noise(SIZE, exponent, 80 + i) for i, exponent in enumerate((0.0, 1.5, 2.5, 3.5))]
    fields += [np.sign(periodic_noise(SIZE, 3.0, 90 + i, low=2)) for i in range(2)]
    fields += [np.sign(np.sin(2 * np.pi * n * u)) for n in (2, 5)] + [np.sin(2 * np.pi * (3 * u + 2 * v))]
    fields += [np.sign(np.sin(2 * np.pi * n * u) * np.sin(2 * np.pi * n * v)) for n in (2, 6)]
    fields += [_cells(12, 95), _cells(60, 96)]
    bank = np.stack([f - f.mean() for f in fields]).astype(np.float32)
    bank /= np.abs(bank).max(axis=(1, 2), keepdims=True)
    bank.setflags(write=False)
    return bank


def _cells(count: int, seed: int) -> Float[np.ndarray, "128 128"]:
    """Voronoi cells on the torus, each with its own value."""
    rng = np.random.default_rng(seed)
    x = (np.arange(SIZE) + 0.5) / SIZE
    texels = np.stack(np.meshgrid(x, x, indexing="ij"), axis=-1).reshape(-1, 2)
    _, nearest = KDTree(rng.random((count, 2)), boxsize=1.0).query(texels)
    return rng.uniform(-1, 1, count)[nearest].reshape(SIZE, SIZE)
