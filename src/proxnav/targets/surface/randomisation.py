"""How far surfaces depart from nominal: random looks of parts that still tell a spacecraft's sides apart."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32

from proxnav.targets.surface.material import Material
from proxnav.targets.surface.patterns.random_fields import field_bank

MILD = 0.3
"""Strength up to which a part keeps its pattern."""
FREE_SHARE = 0.1
"""Share of seeds in which not even the order of tones is kept."""
DARK, LIGHT = 0.2, 0.4
"""Parts below and above these mean albedos are the dark and the light sides."""


@dataclass(frozen=True, slots=True, eq=False)
class Look:
    """What is drawn for one part: factors on the nominal pattern, or, with `mix`, a random texture."""

    tint: tuple[float, float, float]
    """Factor on the albedo; the first colour of a random texture."""
    contrast: float = 1.0
    """Factor on the pattern's departure from 1."""
    accent: float = 1.0
    """Factor on the albedo of gaps and lines."""
    roughness: float = 1.0
    """Factor on the nominal roughness; the roughness itself of a random texture."""
    mix: Float32[np.ndarray, "h w"] | None = None
    """Field in [-1, 1] between the two colours of a random texture."""
    second: tuple[float, float, float] = (0.5, 0.5, 0.5)
    tone: float = 0.5
    """Mean albedo of a random texture."""
    metallic: float = 0.0
    tile_m: float = 1.0
    keep_relief: bool = False
    """Whether a random texture keeps the material's bumps."""


def random_looks(materials: Sequence[Material], strength: float, rng: np.random.Generator) -> list[Look]:
    """One look for each part."""
    wild = max(strength - MILD, 0.0) / (1.0 - MILD)
    kept = float(rng.uniform()) >= FREE_SHARE
    threshold = float(rng.uniform(0.12, 0.45))
    return [
        _wild(material, threshold, kept, rng) if rng.uniform() < wild else _mild(material, min(strength, MILD), rng)
        for material in materials
    ]


def tone_of(albedo: Sequence[float]) -> float:
    """Mean over the three bands, as a panchromatic camera weighs them."""
    return float(np.mean(albedo))


def _mild(material: Material, strength: float, rng: np.random.Generator) -> Look:
    """Tone within +-strength, colour within a third of it, and no albedo above 0.95."""
    tint = (1.0 + strength * rng.uniform(-1, 1)) * (1.0 + strength / 3 * rng.uniform(-1, 1, 3))
    tint *= min(1.0, 0.95 / float(np.max(tint * np.asarray(material.albedo) + 1e-9)))
    contrast, accent, roughness = 1.0 + strength * rng.uniform(-1, 1, 3)
    return Look(_triple(tint), float(contrast), float(accent), float(roughness))


def _wild(material: Material, threshold: float, kept: bool, rng: np.random.Generator) -> Look:
    """Random colours and pattern; with `kept`, dark parts below and light parts above a common threshold of tone."""
    nominal = tone_of(material.albedo)
    low, high = 0.02, 0.85
    if kept and nominal < DARK:
        low, high = 0.02, 0.75 * threshold
    if kept and nominal > LIGHT:
        low, high = min(1.35 * threshold, 0.7), 0.85
    metal = material.metallic > 0.5 and rng.uniform() < 0.7
    return Look(
        tint=_triple(rng.uniform(0.3, 1.0, 3)),
        second=_triple(rng.uniform(0.3, 1.0, 3)),
        mix=_mixed_field(rng),
        tone=float(rng.uniform(low, high)),
        roughness=float(rng.uniform(0.15, 0.9)),
        metallic=1.0 if metal else 0.0,
        tile_m=float(np.exp(rng.uniform(np.log(0.3), np.log(2.5)))),
        keep_relief=bool(rng.uniform() < 0.5),
    )


def _mixed_field(rng: np.random.Generator) -> Float32[np.ndarray, "h w"]:
    """Two fields of the bank, shifted, turned and added."""
    bank = field_bank()
    first, second = (bank[i] for i in rng.integers(len(bank), size=2))
    if rng.uniform() < 0.5:
        first = first.T
    second = np.roll(second, tuple(rng.integers(0, second.shape[0], 2)), axis=(0, 1))
    share, amount = np.float32(rng.uniform(0.0, 0.5)), np.float32(rng.uniform(0.2, 1.0))
    return amount * ((1 - share) * first + share * second)


def _triple(values: Float[np.ndarray, "3"]) -> tuple[float, float, float]:
    return float(values[0]), float(values[1]), float(values[2])
