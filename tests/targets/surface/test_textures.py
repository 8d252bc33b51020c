"""Surfaces: energy, seams, reproducibility, and sides that stay apart."""

import time

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.targets.space_rider import space_rider
from proxnav.targets.surface.patterns.pattern import normals_of_height, periodic_noise
from proxnav.targets.surface.patterns.surfaces import _PATTERNS, nominal_pattern
from proxnav.targets.surface.randomisation import Look, random_looks
from proxnav.targets.surface.textures import part_textures

STRENGTHS = (0.0, 0.3, 0.6, 1.0)


@pytest.mark.parametrize("strength", STRENGTHS)
def test_one_physical_texture_per_part(strength: float):
    target = space_rider()
    textures = part_textures(target, strength, seed=3)
    assert len(textures) == len(target.part_names)
    for texture in textures:
        assert texture.albedo.dtype == np.float32
        assert 0 <= texture.albedo.min() <= texture.albedo.max() < 1
        assert 0 <= texture.metallic.min() <= texture.metallic.max() <= 1
        assert 0 < texture.roughness.min() <= texture.roughness.max() <= 1
        assert texture.tile_m > 0
        if texture.normal is not None:
            np.testing.assert_allclose(np.linalg.norm(texture.normal, axis=-1), 1.0, atol=1e-5)
            assert texture.normal[..., 2].min() > 0.2


@pytest.mark.parametrize("strength", STRENGTHS)
def test_same_seed_gives_same_texels(strength: float):
    first, second = (part_textures(space_rider(), strength, 7) for _ in range(2))
    for a, b in zip(first, second, strict=True):
        np.testing.assert_array_equal(a.albedo, b.albedo)
        np.testing.assert_array_equal(a.roughness, b.roughness)
        assert a.tile_m == b.tile_m


def test_nominal_does_not_depend_on_the_seed():
    assert part_textures(space_rider(), 0.0, 1) is part_textures(space_rider(), 0.0, 2)


def test_nominal_mean_is_near_the_material():
    target = space_rider()
    for material, texture in zip(target.materials, part_textures(target, 0.0, 0), strict=True):
        np.testing.assert_allclose(texture.albedo.mean(axis=(0, 1)), material.albedo, atol=0.05)


def test_mild_jitter_moves_tones_by_at_most_its_share():
    target = space_rider()
    nominal = np.array([t.albedo.mean() for t in part_textures(target, 0.0, 0)])
    ratio = np.array([[t.albedo.mean() for t in part_textures(target, 0.3, seed)] for seed in range(12)]) / nominal
    assert ratio.min() > 0.6
    assert ratio.max() < 1.45
    assert ratio.std() > 0.1


def test_full_randomisation_keeps_sides_apart_in_nine_of_ten_seeds():
    target = space_rider()
    belly, leeside, cells, backs = (
        target.part_names.index(p) for p in ("belly", "leeside", "wing_cells", "wing_backs")
    )

    def apart(looks: list[Look]) -> bool:
        return looks[belly].tone < looks[leeside].tone and looks[cells].tone < looks[backs].tone

    share = np.mean([apart(random_looks(target.materials, 1.0, np.random.default_rng(s))) for s in range(400)])
    assert 0.88 < share < 0.97  # 0.9 + 0.1 / 4 expected


def test_a_random_texture_has_the_tone_of_its_look():
    target = space_rider()
    looks = random_looks(target.materials, 1.0, np.random.default_rng(5))
    means = np.array([texture.albedo.mean() for texture in part_textures(target, 1.0, 5)])
    tones = np.array([look.tone for look in looks])
    np.testing.assert_allclose(means[tones < 0.5], tones[tones < 0.5], atol=0.02)
    np.testing.assert_allclose(means, tones, atol=0.1)  # texels are cut at 0.95: bright patterns lose a little


def test_full_randomisation_varies_tone_and_colour_of_every_part():
    means = np.array([[t.albedo.mean(axis=(0, 1)) for t in part_textures(space_rider(), 1.0, s)] for s in range(15)])
    assert means.mean(axis=2).std(axis=0).min() > 0.04
    assert np.ptp(means / means.mean(axis=2, keepdims=True), axis=0).min() > 0.2


@pytest.mark.parametrize("kind", sorted(_PATTERNS))
def test_patterns_repeat_without_a_seam(kind):
    """The step across the border is no larger than the largest steps inside."""
    pattern = nominal_pattern(kind)
    for field in (pattern.tone, pattern.accent):
        for axis in (0, 1):
            inner = np.abs(np.diff(field, axis=axis)).max()
            across = np.abs(np.take(field, 0, axis) - np.take(field, -1, axis)).max()
            assert across <= 1.25 * inner + 1e-6


def test_normals_of_a_ramp_lean_against_it():
    u = np.arange(64) / 64
    height = np.broadcast_to(0.01 * np.sin(2 * np.pi * u), (64, 64))
    normal = normals_of_height(height, tile_m=1.0)
    slope = 0.01 * 2 * np.pi * np.cos(2 * np.pi * u)
    np.testing.assert_allclose(-normal[0, :, 0] / normal[0, :, 2], slope, atol=2e-4)
    np.testing.assert_allclose(normal[..., 1], 0.0, atol=1e-7)


def test_periodic_noise_has_unit_variance_and_no_long_waves():
    noise = periodic_noise(128, 2.0, seed=5, low=4)
    assert noise.std() == pytest.approx(1.0, abs=1e-3)
    spectrum = np.abs(np.fft.fft2(noise)) ** 2
    assert spectrum[0, 1] + spectrum[1, 0] < 1e-6 * spectrum.sum()


def test_a_whole_target_is_repainted_fast_enough_for_each_training_image():
    target = space_rider()
    part_textures(target, 0.3, 0)
    took = []
    for seed in range(7):
        start = time.thread_time()
        part_textures(target, 0.3, seed)
        took.append(time.thread_time() - start)
    assert min(took) < 0.06  # s of processor time; 0.015 on a free core


def test_strength_outside_its_range_is_refused():
    with pytest.raises(InputError, match="strength"):
        part_textures(space_rider(), 1.5, 0)
