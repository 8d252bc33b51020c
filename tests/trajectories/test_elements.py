"""Orbits in one line."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from proxnav.errors import InputError
from proxnav.geometry.celestial import MU_EARTH
from proxnav.trajectories import OrbitConfig
from proxnav.trajectories.elements import EXAMPLE, fly_elements, parse_elements
from proxnav.trajectories.orbit import fly_orbit

T = np.linspace(0.0, 6000.0, 13)


def test_a_circle_in_one_line_is_the_circle_of_the_options():
    r, v = fly_elements(parse_elements("alt=400km i=51.6 raan=30deg u=20"), T)
    expected = fly_orbit(OrbitConfig(400e3, 51.6, 30.0, 20.0), T)
    assert r == pytest.approx(expected[0], abs=1e-5)
    assert v == pytest.approx(expected[1], abs=1e-8)


def test_an_ellipse_obeys_newton():
    r, v = fly_elements(parse_elements("a=8000km, e=0.1, i=63.4, raan=200, argp=270, M=50"), T)

    def pull(_, y):
        return np.concatenate([y[3:], -MU_EARTH * y[:3] / np.linalg.norm(y[:3]) ** 3])

    flown = solve_ivp(pull, (0.0, T[-1]), np.concatenate([r[0], v[0]]), t_eval=T, rtol=1e-12, atol=1e-6)
    assert r == pytest.approx(flown.y[:3].T, abs=1e-2)
    assert v == pytest.approx(flown.y[3:].T, abs=1e-5)


def test_the_true_anomaly_counts_from_perigee():
    r, _ = fly_elements(parse_elements("a=8000km e=0.1 nu=0"), T[:1])
    assert r[0] == pytest.approx([0.9 * 8e6, 0.0, 0.0])
    r, _ = fly_elements(
        parse_elements("a=8000km e=0.1 argp=10 u=100"), T[:1]
    )  # a quarter turn later: the semi-latus rectum
    assert np.linalg.norm(r[0]) == pytest.approx(8e6 * 0.99)


def test_the_example_of_the_messages_is_one():
    assert parse_elements(EXAMPLE).a_m == 6778137.0


@pytest.mark.parametrize(
    ("text", "said"),
    [("", "write it like a="), ("ISS", "'ISS' is no element"), ("a=6778.137", "a=6778.137 needs a unit, m or km"),
     ("a=6778km foo=3", "foo' is no element"), ("i=51", "give the size"), ("a=7000km alt=400km", "give the size once"),
     ("a=7000km nu=3 M=4", "nu and M both say where the craft is"), ("a=7000m", "check the unit of the size"),
     ("a=7000km e=1.2", "an orbit needs 0 <= e < 1"), ("a=7000km i=1rad", "angles in degrees"),
     ("a=7000km i=1e999", "is no element"), ("a=7000km i=--3", "is no element")],
)  # fmt: skip
def test_a_line_that_is_no_orbit_is_refused_in_a_sentence(text, said):
    with pytest.raises(InputError, match=said):
        parse_elements(text)
