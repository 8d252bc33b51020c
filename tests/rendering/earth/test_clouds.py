"""The cloud field: how much of it there is."""

import cv2
import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.rendering.earth import clouds as cl
from proxnav.rendering.earth import weather
from proxnav.rendering.earth.stored import stored


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
    opacity = np.array([cl.opacity(field, value, 1.0) for value in values])
    assert abs(opacity.mean() - cover) < 0.05
    assert abs((opacity > 0.5).mean() - cover) < 0.04


def test_no_cover_is_no_cloud():
    assert cl.clouds(0.0, 3).threshold == cl.NONE


def test_opacity_grows_with_the_field():
    field = cl.clouds(0.5, 3)
    opacity = [cl.opacity(field, value, 1.0) for value in np.linspace(-1.0, 2.0, 100)]
    assert opacity == sorted(opacity)
    assert opacity[0] == 0.0
    assert opacity[-1] > 0.99


def test_cloud_of_a_picture_is_where_the_picture_is_white(tmp_path):
    picture = np.zeros((180, 360), np.uint8)  # longitude -180 first, north first
    picture[:90, 180:] = 255  # the north-eastern quarter
    picture[90:, :180] = 128
    path = tmp_path / "cloud.png"
    cv2.imwrite(str(path), picture)
    points = sphere(20_000)
    field, values = cl.clouds(0.5, 3, str(path)), np.empty(len(points))
    cl._field_at(field, points, values)
    opacity = np.array([cl.opacity(field, value, 1.0) for value in values])
    north, east = points[:, 2] > 0.1, np.abs(np.arctan2(points[:, 1], points[:, 0]) - np.pi / 2) < 1.4
    south, west = points[:, 2] < -0.1, np.abs(np.arctan2(points[:, 1], points[:, 0]) + np.pi / 2) < 1.4
    assert opacity[north & east].mean() > 0.85
    assert opacity[(north & west) | (south & east)].mean() < 0.02
    assert opacity[south & west].mean() == pytest.approx(0.5, abs=0.1)


def test_a_picture_of_cloud_must_be_twice_as_wide_as_high(tmp_path):
    path = tmp_path / "square.png"
    cv2.imwrite(str(path), np.zeros((64, 64), np.uint8))
    with pytest.raises(InputError, match="twice as wide"):
        cl.clouds(0.5, 0, str(path))


@pytest.mark.slow
def test_the_weather_made_anew_is_the_one_that_was_kept():
    np.testing.assert_array_equal(weather._make(), stored("weather-2", weather._make))
