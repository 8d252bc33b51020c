"""The look of a target's surfaces, nominal or randomised for training: one texture per part."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float32

from proxnav.errors import InputError
from proxnav.targets.surface.material import Material
from proxnav.targets.surface.part_image import PartImage, linear_texels
from proxnav.targets.surface.patterns.pattern import Pattern
from proxnav.targets.surface.patterns.surfaces import nominal_pattern
from proxnav.targets.surface.randomisation import Look, random_looks
from proxnav.targets.target import Target

BRIGHTEST = np.float32(0.98)
"""No surface reflects more."""
SMOOTHEST = np.float32(0.03)
"""Least roughness of a pattern."""


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


@dataclass(frozen=True, slots=True, eq=False)
class PatternedTexture:
    """A part whose texels follow from its pattern by a few numbers; `painted` works them out.

    tone = 1 + contrast (pattern.tone - 1), a = share pattern.accent;
    albedo = base tone + a (accent_albedo - base tone), the others likewise.
    """

    pattern: Pattern
    base: Float32[np.ndarray, "3"]
    """Albedo of the body."""
    accent_albedo: Float32[np.ndarray, "3"]
    contrast: np.float32
    share: np.float32
    metallic: np.float32
    metallic_step: np.float32
    """From the body to the accent."""
    roughness: np.float32
    accent_roughness: np.float32
    ior: float

    @property
    def tile_m(self) -> float:
        """Length [m] after which it repeats."""
        return self.pattern.tile_m

    def painted(self) -> PartTexture:
        """The texels."""
        pattern = self.pattern
        tone = 1.0 + self.contrast * (pattern.tone - 1.0)
        accent = pattern.accent * self.share
        albedo = np.empty((*tone.shape, 3), np.float32)
        for band in range(3):  # plane by plane: numpy is slow where the innermost axis is three long
            body = tone * self.base[band]
            albedo[..., band] = np.clip(body + accent * (self.accent_albedo[band] - body), 0.0, BRIGHTEST)
        metallic = np.clip(self.metallic + accent * self.metallic_step, 0.0, 1.0)
        own = pattern.roughness * self.roughness
        roughness = np.clip(own + accent * (self.accent_roughness - own), SMOOTHEST, 1.0)
        return PartTexture(pattern.tile_m, albedo, metallic, roughness, self.ior, pattern.normal)


def part_textures(target: Target, strength: float, seed: int) -> tuple[PartTexture, ...]:
    """One texture per part; the same arguments give the same texels on every machine.

    Strength 0 is nominal. Up to 0.3 each part keeps its pattern and its tone, contrast and roughness vary by that
    share. Above, a part is given random colours and a random pattern with a probability that grows to 1 at strength 1;
    even then dark parts stay darker than light ones in nine of ten seeds: without that a nearly symmetric spacecraft
    cannot be told from itself turned half round.
    """
    if strength == 0.0:
        return _nominal(target)
    surfaces = part_surfaces(target, strength, seed)
    return tuple(surface.painted() if isinstance(surface, PatternedTexture) else surface for surface in surfaces)


def part_surfaces(target: Target, strength: float, seed: int) -> tuple[PartTexture | PatternedTexture, ...]:
    """The same as `part_textures`, but texels that follow from a pattern are not worked out."""
    if not 0.0 <= strength <= 1.0:
        raise InputError(f"texture strength is {strength}; expected 0 (nominal) to 1 (fully random)")
    looks = random_looks(target.materials, strength, np.random.default_rng(seed)) if strength else None
    looks = looks or [Look(tint=(1.0, 1.0, 1.0))] * len(target.materials)
    return tuple(
        _surface(material, look, target.images.get(name))
        for name, material, look in zip(target.part_names, target.materials, looks, strict=True)
    )


def _surface(material: Material, look: Look, image: PartImage | None) -> PartTexture | PatternedTexture:
    """A random texture where the look asks for one, else the file's picture or the pattern of the material's kind."""
    if look.mix is not None:
        return _random_texture(material, look)
    return _patterned(material, look) if image is None else _pictured(material, look, image)


def _pictured(material: Material, look: Look, image: PartImage) -> PartTexture:
    """The file's picture, its departure from the mean and its tone varied by the look."""
    texels, mean = linear_texels(image), np.asarray(material.albedo, np.float32)
    contrast = np.float32(look.contrast)
    albedo = np.empty_like(texels)
    for band in range(3):
        gain = np.float32(look.tint[band]) * contrast
        offset = np.float32(look.tint[band]) * (1 - contrast) * mean[band]
        np.clip(texels[..., band] * gain + offset, 0.0, BRIGHTEST, out=albedo[..., band])
    metallic = np.full(texels.shape[:2], material.metallic, np.float32)
    roughness = np.full(texels.shape[:2], np.clip(material.roughness * look.roughness, SMOOTHEST, 1.0), np.float32)
    return PartTexture(image.tile_m, albedo, metallic, roughness, material.ior, None)


@lru_cache(maxsize=8)
def _nominal(target: Target) -> tuple[PartTexture, ...]:
    surfaces = part_surfaces(target, 0.0, 0)
    return tuple(surface.painted() if isinstance(surface, PatternedTexture) else surface for surface in surfaces)


def _patterned(material: Material, look: Look) -> PatternedTexture:
    """The pattern of a material's kind in a given look."""
    pattern = nominal_pattern(material.kind)
    return PatternedTexture(
        pattern=pattern,
        base=np.asarray(material.albedo, np.float32) * np.asarray(look.tint, np.float32),
        accent_albedo=np.asarray(pattern.accent_albedo, np.float32) * np.float32(look.accent),
        contrast=np.float32(look.contrast),
        share=np.float32(min(look.contrast, 1.0)),
        metallic=np.float32(material.metallic),
        metallic_step=np.float32(pattern.accent_metallic - material.metallic),
        roughness=np.float32(material.roughness * look.roughness),
        accent_roughness=np.float32(pattern.accent_roughness),
        ior=material.ior,
    )


def _random_texture(material: Material, look: Look) -> PartTexture:
    """Two colours mixed by a random field, scaled so that the mean has the look's tone."""
    assert look.mix is not None
    share = np.clip(0.5 + 0.5 * look.mix, 0.0, 1.0)
    first, second = np.asarray(look.tint, np.float32), np.asarray(look.second, np.float32)
    albedo = np.stack([first[band] + share * (second[band] - first[band]) for band in range(3)], axis=-1)
    albedo *= np.float32(look.tone / max(float(albedo.mean()), 1e-6))
    metallic = np.full(look.mix.shape, look.metallic, np.float32)
    roughness = np.clip(np.float32(look.roughness) * (1.0 + np.float32(0.4) * look.mix), 0.05, 1.0)
    normal = nominal_pattern(material.kind).normal if look.keep_relief else None
    if normal is not None:
        normal = np.ascontiguousarray(normal[::2, ::2])
    return PartTexture(look.tile_m, np.clip(albedo, 0.005, 0.95), metallic, roughness, material.ior, normal)
