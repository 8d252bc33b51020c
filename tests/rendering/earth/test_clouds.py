"""The cloud field: how much of it there is."""

import numpy as np
import pytest

from proxnav.rendering.earth import clouds as cl


def sphere(n: int) -> np.ndarray:
    """Points spread evenly on the unit sphere."""
    i = np.arange(n) + 0.5
    z = 1.0 - 2.0 * i / n
    turn, ring = np.pi * (1.0 + np.sqrt(5.0)) * i, np.sqrt(1.0 - z * z)
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=-1)


@pytest.mark.parametrize("seed", [1, 5])
@pytest.mark.parametrize("cover", [0.1, 0.3, 0.5, 0.7, 0.9])
def test_mean_opacity_is_the_cover_that_was_asked_for(cover, seed):
    field, values = cl.clouds(cover, seed), np.empty(10_000)
    cl._field_at(field, sphere(len(values)), values)
    opacity = np.array([cl.opacity(field, value) for value in values])
    assert abs(opacity.mean() - cover) < 0.05
    assert abs((opacity > 0.5).mean() - cover) < 0.04


def test_no_cover_is_no_cloud():
    assert cl.clouds(0.0, 3).threshold == cl.NONE


def test_opacity_grows_with_the_field():
    field = cl.clouds(0.5, 3)
    opacity = [cl.opacity(field, value) for value in np.linspace(-1.0, 2.0, 100)]
    assert opacity == sorted(opacity)
    assert opacity[0] == 0.0
    assert opacity[-1] > 0.99
