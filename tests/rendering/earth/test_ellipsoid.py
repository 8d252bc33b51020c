"""Rays against the ellipsoid, with closed forms as references."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from proxnav.geometry.celestial import EARTH_POLAR_RADIUS as B_M
from proxnav.rendering.earth.ellipsoid import A_M, intersect


def test_rays_along_the_axes_meet_the_equator_and_the_poles():
    down = np.array([[-1.0, 0.0, 0.0]])
    assert np.isclose(intersect(np.array([A_M + 400e3, 0, 0]), down)[0], 400e3, atol=1e-6)  # m
    south = np.array([[0.0, 0.0, -1.0]])
    assert np.isclose(intersect(np.array([0, 0, B_M + 400e3]), south)[0], 400e3, atol=1e-6)  # m


@given(st.tuples(*[st.floats(-1, 1)] * 3), st.floats(300e3, 4e7), st.integers(0, 2**31))
def test_landing_points_lie_on_the_ellipsoid(direction, altitude_m, seed):
    d = np.array(direction)
    if np.linalg.norm(d) < 1e-2:
        return
    origin = d / np.linalg.norm(d) * (A_M + altitude_m)
    aim = np.random.default_rng(seed).normal(size=3)
    aim *= 0.9 * B_M / np.linalg.norm(aim)
    ray = (aim - origin) / np.linalg.norm(aim - origin)
    t = intersect(origin, ray[None])[0]
    x, y, z = origin + t * ray
    assert t > 0.0
    assert abs((x / A_M) ** 2 + (y / A_M) ** 2 + (z / B_M) ** 2 - 1.0) < 1e-12


def test_the_horizon_at_400_km_dips_by_19_8_degrees():
    r = A_M + 400e3
    angles = np.radians(np.arange(69.0, 72.0, 0.001))  # from nadir, in the equatorial plane
    rays = np.stack([-np.cos(angles), np.sin(angles), 0.0 * angles], axis=-1)
    edge = np.degrees(angles[intersect(np.array([r, 0.0, 0.0]), rays) > 0.0].max())
    assert abs(edge - 70.2) < 0.05  # deg
    assert abs(90.0 - edge - 19.8) < 0.05  # deg


def test_rays_that_look_away_miss():
    assert intersect(np.array([A_M + 400e3, 0, 0]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])).tolist() == [-1, -1]
