"""The look of a target's surfaces, nominal or randomised for training: one texture per part."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float32

from proxnav.errors import InputError
from proxnav.targets.material import Material
from proxnav.targets.patterns.pattern import Pattern
from proxnav.targets.patterns.surfaces import nominal_pattern
from proxnav.targets.randomisation import Look, random_looks
from proxnav.targets.target import Target


@dataclass(frozen=True, slots=True, eq=False)
class PartTexture:
    """Reflectance over one repeating tile of surface; uv = corner_uv_m / tile_m.

    Texel (row i, column j) is centred at u = (j + 0.5) / w, v = (i + 0.5) / h; v grows with the row.
    """

    tile_m: float
    albedo: Float32[np.ndarray, "h w 3"]
    """Linear reflectance in the bands 600-700, 500-600 and 400-500 nm; absolute, not relative to the material."""
    metallic: Float32[np.ndarray, "h w"]
    roughness: Float32[np.ndarray, "h w"]
    ior: float
    normal: Float32[np.ndarray, "h w 3"] | None
    """Tangent-space unit normals: x along u, y along v, z outward; None for a flat surface."""


def part_textures(target: Target, strength: float, seed: int) -> tuple[PartTexture, ...]:
    """One texture per part; the same arguments give the same texels on every machine.

    Strength 0 is nominal. Up to 0.3 each part keeps its pattern and its tone, contrast and roughness vary by that
    share. Above, a part is given random colours and a random pattern with a probability that grows to 1 at strength 1;
    even then dark parts stay darker than light ones in nine of ten seeds: without that a nearly symmetric spacecraft
    cannot be told from itself turned half round.
    """
    if not 0.0 <= strength <= 1.0:
        raise InputError(f"texture strength is {strength}; expected 0 (nominal) to 1 (fully random)")
    if strength == 0.0:
        return _nominal(target)
    looks = random_looks(target.materials, strength, np.random.default_rng(seed))
    return tuple(_paint(material, look) for material, look in zip(target.materials, looks, strict=True))


@lru_cache(maxsize=8)
def _nominal(target: Target) -> tuple[PartTexture, ...]:
    return tuple(_paint(material, Look(tint=(1.0, 1.0, 1.0))) for material in target.materials)


def _paint(material: Material, look: Look) -> PartTexture:
    """The texels of a material in a given look."""
    if look.mix is not None:
        return _random_texture(material, look)
    pattern = nominal_pattern(material.kind)
    tone = 1.0 + np.float32(look.contrast) * (pattern.tone - 1.0)
    base = np.asarray(material.albedo, np.float32) * np.asarray(look.tint, np.float32)
    accent = (pattern.accent * np.float32(min(look.contrast, 1.0)))[..., None]
    body = tone[..., None] * base
    albedo = body + accent * (np.asarray(pattern.accent_albedo, np.float32) * np.float32(look.accent) - body)
    metallic, roughness = _finish(material, pattern, accent[..., 0], look)
    return PartTexture(pattern.tile_m, np.clip(albedo, 0.0, 0.98), metallic, roughness, material.ior, pattern.normal)


def _finish(
    material: Material, pattern: Pattern, accent: Float32[np.ndarray, "h w"], look: Look
) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Metallic and roughness over the tile."""
    metallic = np.float32(material.metallic) + accent * np.float32(pattern.accent_metallic - material.metallic)
    own = pattern.roughness * np.float32(material.roughness * look.roughness)
    roughness = own + accent * (np.float32(pattern.accent_roughness) - own)
    return np.clip(metallic, 0.0, 1.0), np.clip(roughness, 0.03, 1.0)


def _random_texture(material: Material, look: Look) -> PartTexture:
    """Two colours mixed by a random field, scaled so that the mean has the look's tone."""
    assert look.mix is not None
    share = np.clip(0.5 + 0.5 * look.mix, 0.0, 1.0)[..., None]
    first, second = np.asarray(look.tint, np.float32), np.asarray(look.second, np.float32)
    albedo = first + share * (second - first)
    albedo *= np.float32(look.tone / max(float(albedo.mean()), 1e-6))
    metallic = np.full(look.mix.shape, look.metallic, np.float32)
    roughness = np.clip(np.float32(look.roughness) * (1.0 + np.float32(0.4) * look.mix), 0.05, 1.0)
    normal = nominal_pattern(material.kind).normal if look.keep_relief else None
    if normal is not None:
        normal = np.ascontiguousarray(normal[::2, ::2])
    return PartTexture(look.tile_m, np.clip(albedo, 0.005, 0.95), metallic, roughness, material.ior, normal)
