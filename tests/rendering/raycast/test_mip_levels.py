"""Levels of texels straight from patterns against the painted textures that Blender gets."""

import numpy as np
import pytest

from proxnav.rendering.raycast.texels import build_table
from proxnav.targets.loading import load_target
from proxnav.targets.surface.textures import part_surfaces, part_textures


@pytest.mark.parametrize(("strength", "finest_m"), [(0.0, 1e-4), (0.3, 0.01), (0.7, 0.02)])
def test_patterned_surfaces_give_the_texels_of_painted_ones_to_the_bit(strength: float, finest_m: float):
    target = load_target("space-rider")
    quick = build_table(part_surfaces(target, strength, 5), target.materials, finest_m)
    painted = build_table(part_textures(target, strength, 5), target.materials, finest_m)
    np.testing.assert_array_equal(quick.texels, painted.texels)
    np.testing.assert_array_equal(quick.means, painted.means)
    np.testing.assert_array_equal(quick.parts, painted.parts)


def test_coarsest_texel_is_the_mean_of_the_finest():
    target = load_target("space-rider")
    textures = part_textures(target, 0.2, 1)
    table = build_table(part_surfaces(target, 0.2, 1), target.materials)
    for texture, mean in zip(textures, table.means, strict=True):
        np.testing.assert_allclose(mean[:3] + mean[4:7], texture.albedo.mean(axis=(0, 1), dtype=np.float64), rtol=1e-5)
