"""Lets the tests of this folder share their shapes, and take the pattern off surfaces where a number must be exact."""

import sys
from pathlib import Path

import numpy as np
import pytest

from proxnav.rendering.raycast import model
from proxnav.targets import Target
from proxnav.targets.surface.textures import PartTexture

sys.path.insert(0, str(Path(__file__).parent))


def _even(target: Target, strength: float, seed: int) -> tuple[PartTexture, ...]:
    """One texel per part: what the material says."""
    one = np.ones((1, 1), np.float32)
    return tuple(
        PartTexture(1.0, np.full((1, 1, 3), m.albedo, np.float32), m.metallic * one, m.roughness * one, m.ior, None)
        for m in target.materials
    )


@pytest.fixture
def even_surfaces(monkeypatch: pytest.MonkeyPatch) -> None:
    """Surfaces without the unevenness of real paint."""
    monkeypatch.setattr(model, "part_surfaces", _even)
