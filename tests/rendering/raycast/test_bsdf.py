"""The reflectance model against what physics and other sources say about it."""

import numpy as np
import pytest
from scipy import integrate

from proxnav.rendering.raycast.bsdf import fresnel, ggx, lobe_albedo_table, reflectance, table_albedo


def lobe(view: np.ndarray, light: np.ndarray, alpha: float) -> float:
    h = (view + light) / np.linalg.norm(view + light)
    return ggx(light[2], view[2], h[2], alpha)


def direction(polar: float, azimuth: float) -> np.ndarray:
    return np.array([np.sin(polar) * np.cos(azimuth), np.sin(polar) * np.sin(azimuth), np.cos(polar)])


def test_fresnel_at_normal_incidence_and_grazing() -> None:
    assert fresnel(1.0, 1.5) == pytest.approx(0.04)
    assert fresnel(1e-6, 1.5) == pytest.approx(1.0, abs=1e-4)
    assert fresnel(0.3, 1.0) == 0.0


@pytest.mark.parametrize("cosine", [0.2, 0.5, 0.9])
def test_fresnel_is_the_mean_of_both_polarisations(cosine: float) -> None:
    inner = np.sqrt(1.0 - (1.0 - cosine**2) / 1.5**2)
    s = ((cosine - 1.5 * inner) / (cosine + 1.5 * inner)) ** 2
    p = ((inner - 1.5 * cosine) / (inner + 1.5 * cosine)) ** 2
    assert fresnel(cosine, 1.5) == pytest.approx(0.5 * (s + p))


@pytest.mark.parametrize("alpha", [0.1, 0.4, 1.0])
def test_the_lobe_is_reciprocal(alpha: float, rng: np.random.Generator) -> None:
    for _ in range(20):
        a, b = (direction(rng.uniform(0, 1.5), rng.uniform(0, 6.28)) for _ in range(2))
        assert lobe(a, b, alpha) == pytest.approx(lobe(b, a, alpha), rel=1e-12)


@pytest.mark.parametrize(("alpha", "polar"), [(0.25, 0.0), (0.25, 1.0), (0.6, 0.5), (1.0, 1.2)])
def test_the_albedo_table_is_the_integral_of_the_lobe(alpha: float, polar: float) -> None:
    view = direction(polar, 0.0)

    def integrand(azimuth: float, theta: float) -> float:
        light = direction(theta, azimuth)
        return lobe(view, light, alpha) * light[2] * np.sin(theta)

    expected = 2.0 * integrate.dblquad(integrand, 0.0, np.pi / 2, 0.0, np.pi, epsabs=1e-4, epsrel=1e-4)[0]
    assert expected <= 1.0
    assert table_albedo(lobe_albedo_table(), view[2], alpha) == pytest.approx(expected, abs=0.01)


def test_no_material_reflects_more_than_it_receives() -> None:
    """A white furnace: both lobes of a white dielectric and of a white metal together stay below one."""
    f, white = np.empty(3), np.ones(3)
    polar, azimuth = np.meshgrid((np.arange(60) + 0.5) * np.pi / 120, (np.arange(60) + 0.5) * np.pi / 30)
    solid = np.sin(polar) * (np.pi / 120) * (np.pi / 30)
    for metallic, angle in ((0.0, 0.3), (0.0, 1.3), (1.0, 0.3), (1.0, 1.3)):
        view, total = direction(angle, 0.0), 0.0
        for p, a, w in zip(polar.ravel(), azimuth.ravel(), solid.ravel(), strict=True):
            light = direction(p, a)
            h = (view + light) / np.linalg.norm(view + light)
            reflectance(
                light[2],
                view[2],
                h[2],
                (1.0 - metallic) * white,
                metallic * white,
                metallic,
                0.3,
                fresnel(view[2], 1.5),
                f,
            )
            total += f[0] * light[2] * w
        assert 0.75 < total < 1.01
