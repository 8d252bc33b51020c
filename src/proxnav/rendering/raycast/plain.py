"""Textures of one texel: each part as its material says, before any pattern."""

from dataclasses import dataclass

import numpy as np

from proxnav.targets import Target


@dataclass(frozen=True, slots=True, eq=False)
class PlainTexture:
    """A part of one colour."""

    tile_m: float
    albedo: np.ndarray
    metallic: np.ndarray
    roughness: np.ndarray
    ior: float
    normal: np.ndarray | None


def part_textures(target: Target, strength: float, seed: int) -> tuple[PlainTexture, ...]:
    """One texel per part."""
    return tuple(
        PlainTexture(
            1.0, np.full((1, 1, 3), m.albedo), np.full((1, 1), m.metallic), np.full((1, 1), m.roughness), m.ior, None
        )
        for m in target.materials
    )
