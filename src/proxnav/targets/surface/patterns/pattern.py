"""What a surface pattern is, and the periodic noise that patterns are made of."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int

Field = Float32[np.ndarray, "h w"]


@dataclass(frozen=True, slots=True, eq=False)
class Pattern:
    """Variation of one tile of surface about its part's nominal reflectance; it repeats without a seam."""

    tile_m: float
    """Length [m] after which it repeats, along u and along v."""
    tone: Field
    """Factor on the albedo, about 1."""
    accent: Field
    """Share, 0 to 1, of a second substance: gaps, threads, finger lines, tape."""
    accent_albedo: tuple[float, float, float]
    accent_metallic: float
    accent_roughness: float
    roughness: Field
    """Factor on the roughness, about 1."""
    normal: Float32[np.ndarray, "h w 3"] | None
    """Tangent-space unit normals: x along u, y along v (with the row), z outward."""


def periodic_noise(size: int, exponent: float, seed: int, low: int = 1) -> Field:
    """Zero-mean, unit-variance noise on a torus with power ~ frequency^-exponent from `low` cycles per tile up."""
    spectrum = np.fft.rfft2(np.random.default_rng(seed).standard_normal((size, size)))
    cycles = np.hypot(np.fft.fftfreq(size)[:, None], np.fft.rfftfreq(size)[None, :]) * size
    gain = np.where(cycles >= low, np.maximum(cycles, 1.0) ** (-exponent / 2), 0.0)
    noise = np.fft.irfft2(spectrum * gain, s=(size, size))
    return ((noise - noise.mean()) / noise.std()).astype(np.float32)


def normals_of_height(height_m: Float[np.ndarray, "h w"], tile_m: float) -> Float32[np.ndarray, "h w 3"]:
    """Unit normals of a periodic height field [m] over a square tile: (-dh/du, -dh/dv, 1), normalised."""
    step = tile_m / height_m.shape[0]
    slope_u = (np.roll(height_m, -1, axis=1) - np.roll(height_m, 1, axis=1)) / (2 * step)
    slope_v = (np.roll(height_m, -1, axis=0) - np.roll(height_m, 1, axis=0)) / (2 * step)
    normal = np.stack([-slope_u, -slope_v, np.ones_like(height_m)], axis=-1)
    return (normal / np.linalg.norm(normal, axis=-1, keepdims=True)).astype(np.float32)


def cell_index(
    size: int, rows: int, columns: int
) -> tuple[Int[np.ndarray, "h w"], Float[np.ndarray, "h w"], Float[np.ndarray, "h w"]]:
    """For each texel of a regular grid: its cell's number, and its place (row, column) in the cell, 0 to 1."""
    i, j = np.meshgrid((np.arange(size) + 0.5) / size * rows, (np.arange(size) + 0.5) / size * columns, indexing="ij")
    return i.astype(int) * columns + j.astype(int), i % 1.0, j % 1.0


def edge_distance(place: Float[np.ndarray, "h w"], pitch_m: float) -> Float[np.ndarray, "h w"]:
    """Distance [m] to the nearer border of the cell, along one direction."""
    return np.minimum(place, 1.0 - place) * pitch_m
