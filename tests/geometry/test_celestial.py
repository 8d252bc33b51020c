"""Sun, Moon, Earth's rotation and shadow against published examples and closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxnav.geometry import celestial, quaternion
from proxnav.geometry.arrays import unit

MIDNIGHT = np.array(0.0)
ORBIT_M = celestial.EARTH_EQUATORIAL_RADIUS + 400e3
SUN = np.array([1.0, 0.0, 0.0])


def angle_deg(a, b):
    return np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), np.dot(a, b)))


def test_sun_agrees_with_vallados_example_5_1():
    """Vallado, Fundamentals of Astrodynamics, example 5-1: mean of date; and its ICRF row of the almanac [km]."""
    epoch = "2006-04-02T00:00:00Z"
    s = celestial.sun_direction_eci(epoch, MIDNIGHT)
    assert angle_deg(s, [146259922.0, 28585947.0, 12397430.0]) < 0.01
    of_date = quaternion.rotate(quaternion.conjugate(celestial.q_eci_mod(epoch, MIDNIGHT)), s)
    assert angle_deg(of_date, [146186212.0, 28788976.0, 12481064.0]) < 0.001
    assert celestial.sun_distance_m(epoch, MIDNIGHT) == pytest.approx(1.49490e11, rel=2e-4)


def test_moon_agrees_with_vallados_example_5_3():
    epoch = "1994-04-28T00:00:00Z"
    q_mod_eci = quaternion.conjugate(celestial.q_eci_mod(epoch, MIDNIGHT))
    moon = quaternion.rotate(q_mod_eci, celestial.moon_direction_eci(epoch, MIDNIGHT))
    assert angle_deg(moon, [-134240.626, -311571.590, -126693.785]) < 0.005


def test_sidereal_time_agrees_with_vallados_example_3_5():
    assert np.degrees(celestial.gmst("1992-08-20T12:14:00Z", MIDNIGHT)) == pytest.approx(152.578787886, abs=1e-6)


def test_geodetic_position_agrees_with_vallados_example_3_3():
    latitude, longitude = np.deg2rad(34.352496), np.deg2rad(46.4464)
    r = celestial.geodetic_to_ecef(latitude, longitude, 5085218.7)
    assert np.abs(r - [6524834.0, 6862875.0, 6448296.0]).max() < 5.0  # m, the example prints whole metres of 1e-6 deg


def test_precession_moves_the_equinox_by_fifty_arcseconds_a_year():
    q = celestial.q_eci_mod("2050-01-01T12:00:00Z", MIDNIGHT)
    x_j2000 = quaternion.rotate(q, np.array([1.0, 0.0, 0.0]))
    assert angle_deg(x_j2000, [1.0, 0.0, 0.0]) == pytest.approx(50.29 * 50 / 3600, rel=2e-3)
    assert x_j2000[1] < 0  # the equinox moves westward


def test_earth_turns_once_in_a_stellar_day():
    day = np.array([0.0, 86164.0989])  # stellar day: against the stars, not the equinox
    q = celestial.q_eci_ecef("2024-11-01T00:00:00Z", day)
    assert quaternion.angle_between(q[0], q[1]) < 4e-7  # rad; the pole itself moves by 2.7e-7 a day
    hour = celestial.q_eci_ecef("2024-11-01T00:00:00Z", np.array([0.0, 3600.0]))
    rate = quaternion.log(quaternion.multiply(hour[1], quaternion.conjugate(hour[0]))) / 3600.0
    assert np.abs(rate - [0.0, 0.0, celestial.EARTH_RATE]).max() < 3e-7  # eastward, about the pole of date


def test_greenwich_faces_the_sun_at_noon():
    noon = np.array(43200.0)
    q = celestial.q_eci_ecef("2024-04-15T00:00:00Z", noon)  # equation of time is zero here
    sun_ecef = quaternion.rotate(quaternion.conjugate(q), celestial.sun_direction_eci("2024-04-15T00:00:00Z", noon))
    assert abs(np.degrees(np.arctan2(sun_ecef[1], sun_ecef[0]))) < 0.1
    assert np.degrees(np.arcsin(sun_ecef[2])) == pytest.approx(9.9, abs=0.2)


def test_eclipse_lasts_thirty_six_minutes_in_the_plane_of_the_sun():
    phi = np.linspace(0.0, 2.0 * np.pi, 200_001)
    r = ORBIT_M * np.stack([np.cos(phi), np.sin(phi), np.zeros_like(phi)], axis=-1)
    lit = celestial.sun_visible_fraction(r, SUN)
    period_min = 2.0 * np.pi * np.sqrt(ORBIT_M**3 / celestial.MU_EARTH) / 60.0
    assert (1.0 - lit).mean() * period_min == pytest.approx(36.1, abs=0.1)
    penumbra_s = ((lit > 0) & (lit < 1)).mean() * period_min * 60.0 / 2.0
    assert penumbra_s == pytest.approx(2 * 0.00465 * 5553.6 / (2 * np.pi) / np.sin(np.deg2rad(70.2)), rel=0.1)


def test_half_the_sun_is_visible_when_its_centre_grazes_the_limb():
    dip = np.arccos(celestial.EARTH_EQUATORIAL_RADIUS / ORBIT_M)
    r = ORBIT_M * np.array([-np.sin(dip), np.cos(dip), 0.0])
    assert celestial.sun_visible_fraction(r, SUN, 1e6 * celestial.ASTRONOMICAL_UNIT) in (0.0, 1.0)
    far_sun = celestial.sun_visible_fraction(r, SUN)
    assert far_sun == pytest.approx(0.5, abs=0.02)


def test_an_annular_eclipse_hides_the_share_of_the_areas():
    r = np.array([-3e9, 0.0, 0.0])
    a = celestial.SUN_RADIUS / (celestial.ASTRONOMICAL_UNIT + 3e9)
    expected = 1.0 - (celestial.EARTH_EQUATORIAL_RADIUS / 3e9 / a) ** 2
    assert celestial.sun_visible_fraction(r, SUN) == pytest.approx(expected, rel=1e-4)


@given(st.floats(0.0, 2.0 * np.pi), st.floats(-np.pi / 2, np.pi / 2), st.floats(6.5e6, 1e8))
def test_visible_fraction_is_a_share_and_full_on_the_day_side(longitude, latitude, radius):
    r = radius * np.array(
        [np.cos(latitude) * np.cos(longitude), np.cos(latitude) * np.sin(longitude), np.sin(latitude)]
    )
    lit = celestial.sun_visible_fraction(r, SUN)
    assert 0.0 <= lit <= 1.0
    if r[0] > 0:
        assert lit == 1.0


@pytest.mark.parametrize("batch", [(), (1,), (5,)])
def test_orbit_frames_are_right_handed_and_point_as_named(batch, rng):
    r = rng.normal(size=(*batch, 3)) * 7e6
    v = rng.normal(size=(*batch, 3)) * 7e3
    for R in (celestial.R_eci_ric(r, v), celestial.R_eci_lvlh(r, v)):
        assert np.abs(np.swapaxes(R, -1, -2) @ R - np.eye(3)).max() < 1e-12
        assert np.abs(np.linalg.det(R) - 1.0).max() < 1e-12
    ric, lvlh = celestial.R_eci_ric(r, v), celestial.R_eci_lvlh(r, v)
    assert np.abs(ric[..., 0] - unit(r)).max() < 1e-12
    assert (np.sum(ric[..., 1] * v, axis=-1) > 0).all()
    assert np.abs(lvlh[..., 2] + unit(r)).max() < 1e-12
    assert np.abs(lvlh[..., 0] - ric[..., 1]).max() < 1e-12


def test_lvlh_of_an_equatorial_orbit_by_hand():
    R = celestial.R_eci_lvlh(np.array([7e6, 0.0, 0.0]), np.array([0.0, 7.5e3, 0.0]))
    assert R.tolist() == [[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]  # forward y, right -z, down -x
