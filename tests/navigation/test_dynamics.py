"""Relative motion against numerical two-body motion and against an outside library."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from jaxtyping import Float

from navigation.orbits import ELLIPSE_STATE, TWO_BODY, A, N, target_at
from proxnav.errors import InputError
from proxnav.flight.orbit_forces import Burn, ForceConfig, acceleration, fly
from proxnav.geometry.celestial import MU_EARTH
from proxnav.geometry.relative_motion import cw_transition, eci_from_ric, ric_from_eci
from proxnav.navigation.kernels.relative import gradient_transition, gravity_gradient
from proxnav.navigation.relative_elements import (
    Elements,
    RelativeElements,
    drift_under_j2,
    elements,
    passive_safety_closed_m,
    passive_safety_m,
    relative_elements,
    relative_position,
)
from proxnav.navigation.yamanaka_ankersen import reference_orbit, solve_kepler, ya_transition


def numerical(e: float, nu: float, rho: np.ndarray, rho_dot: np.ndarray, t: np.ndarray) -> Float[np.ndarray, "n 6"]:
    """Relative state in RIC by integrating both orbits."""
    r, v = target_at(e, nu)
    start = np.concatenate([r, v, *eci_from_ric(r, v, rho, rho_dot)])
    y = fly(start, t, TWO_BODY)
    return np.concatenate(ric_from_eci(y[:, :3], y[:, 3:6], y[:, 6:9], y[:, 9:]), axis=1)


def test_integrator_keeps_the_energy_of_an_eccentric_orbit() -> None:
    r, v = target_at(0.1, 0.4)
    y = fly(np.concatenate([r, v, r, v]), np.linspace(0.0, 12_000.0, 50), TWO_BODY)
    energy = 0.5 * np.sum(y[:, 3:6] ** 2, axis=1) - MU_EARTH / np.linalg.norm(y[:, :3], axis=1)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-10)


def test_clohessy_wiltshire_follows_two_body_motion_on_a_circle() -> None:
    t = np.linspace(0.0, 5553.6, 30)
    found = numerical(0.0, 0.0, *ELLIPSE_STATE, t)
    predicted = np.array([cw_transition(float(N), float(s)) @ found[0] for s in t])
    assert (
        np.abs(predicted - found)[:, :3].max() < 0.05
    )  # m over one orbit at 60 m: the neglected rho^2/a grows along-track
    assert np.abs(predicted - found)[:10, :3].max() < 0.01  # m over a third of an orbit


@pytest.mark.parametrize("e", [0.0, 0.001, 0.02, 0.1, 0.6])
@pytest.mark.parametrize("nu", [0.0, 2.1, -1.3])
def test_yamanaka_ankersen_follows_two_body_motion(e: float, nu: float) -> None:
    t = np.linspace(0.0, 3000.0, 13)
    rho, rho_dot = np.array([1.5, -4.0, 1.2]), np.array([2e-4, -3e-3, -4e-4])
    found = numerical(e, nu, rho, rho_dot, t)
    orbit = reference_orbit(*target_at(e, nu))
    predicted = np.array([ya_transition(orbit, float(s)) @ found[0] for s in t])
    farthest = np.linalg.norm(found[:, :3], axis=1).max()
    allowed = 1e-4 + 40.0 * farthest**2 / np.linalg.norm(
        target_at(e, nu)[0]
    )  # m: the neglected rho^2/a, some times over
    assert np.abs(predicted - found)[:, :3].max() < allowed


def test_yamanaka_ankersen_is_clohessy_wiltshire_on_a_circle() -> None:
    orbit = reference_orbit(*target_at(0.0, 0.9))
    np.testing.assert_allclose(ya_transition(orbit, 1234.5), cw_transition(float(N), 1234.5), rtol=1e-6, atol=1e-6)


@given(st.floats(0.0, 0.7), st.floats(-3.0, 3.0), st.floats(1.0, 4000.0), st.floats(1.0, 4000.0))
@settings(max_examples=40, deadline=None)
def test_transitions_compose(e: float, nu: float, first: float, second: float) -> None:
    orbit = reference_orbit(*target_at(e, nu))
    later = type(orbit)(orbit.semi_latus_rectum_m, orbit.eccentricity, orbit.true_anomaly_after(first))
    whole, parts = ya_transition(orbit, first + second), ya_transition(later, second) @ ya_transition(orbit, first)
    np.testing.assert_allclose(parts, whole, atol=1e-6 * np.abs(whole).max())


def test_an_open_orbit_is_refused() -> None:
    with pytest.raises(InputError, match="eccentricity below 1"):
        reference_orbit(np.array([A, 0.0, 0.0]), np.array([0.0, 12_000.0, 0.0]))


@given(st.floats(-20.0, 20.0), st.floats(0.0, 0.95))
def test_keplers_equation_is_solved(M: float, e: float) -> None:
    E = solve_kepler(M, e)
    assert abs(E - e * np.sin(E) - M) < 1e-12  # rad


def safety_ellipse() -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Target and chaser on a bounded ellipse of 15 m by 12 m across the flight."""
    target = target_at(0.0, 0.0)
    rho = np.array([15.0, 0.0, 12.0])
    return target, eci_from_ric(*target, rho, np.array([0.0, -2 * N * 15.0, 0.0]))


def test_relative_elements_give_the_position_of_two_body_motion() -> None:
    target, chaser = safety_ellipse()
    both = elements(*target)
    roe = relative_elements(both, elements(*chaser))
    t = np.linspace(0.0, 5000.0, 40)
    y = fly(np.concatenate([*target, *chaser]), t, TWO_BODY)
    found = ric_from_eci(y[:, :3], y[:, 3:6], y[:, 6:9], y[:, 9:])[0]
    u = both.u + N * t
    np.testing.assert_allclose(relative_position(roe, both.a_m, u, both.u), found, atol=0.01)  # m on 60 m


def test_passive_safety_is_the_least_distance_flown_across_the_flight() -> None:
    target, chaser = safety_ellipse()
    roe = relative_elements(elements(*target), elements(*chaser))
    y = fly(np.concatenate([*target, *chaser]), np.linspace(0.0, 5553.6, 2000), TWO_BODY)
    rho = ric_from_eci(y[:, :3], y[:, 3:6], y[:, 6:9], y[:, 9:])[0]
    flown = np.hypot(rho[:, 0], rho[:, 2]).min()
    assert abs(passive_safety_m(roe, A) - flown) < 0.02  # m


@given(st.lists(st.floats(-1e-5, 1e-5), min_size=4, max_size=4))
def test_passive_safety_in_closed_form_agrees_with_the_search(parts: list[float]) -> None:
    roe = RelativeElements(0.0, 0.0, *parts)
    assert abs(passive_safety_m(roe, A) - passive_safety_closed_m(roe, A)) < 0.15  # m, the search's step


def test_parallel_vectors_are_safe_and_perpendicular_ones_are_not() -> None:
    safe = RelativeElements(0.0, 0.0, 0.0, 15.0 / A, 0.0, 12.0 / A)
    unsafe = RelativeElements(0.0, 0.0, 15.0 / A, 0.0, 0.0, 12.0 / A)
    assert abs(passive_safety_m(safe, A) - 12.0) < 1e-6  # m
    assert passive_safety_m(unsafe, A) < 0.05  # m


def test_j2_turns_the_relative_eccentricity_as_the_first_order_theory_says() -> None:
    target, chaser = safety_ellipse()
    start = np.concatenate([*target, *chaser])
    orbits = 3
    t = np.linspace(0.0, (orbits + 1) * 2 * np.pi / N, 60 * (orbits + 1) + 1)
    y = fly(start, t, ForceConfig(density_kg_m3=0.0))
    series = np.array(
        [relative_elements(elements(s[:3], s[3:6]), elements(s[6:9], s[9:])).vector for s in y]
    )  # osculating: a mean over each revolution removes the short period
    first, last = series[:60].mean(axis=0), series[60 * orbits : 60 * (orbits + 1)].mean(axis=0)
    turned = np.arctan2(last[3], last[2]) - np.arctan2(first[3], first[2])
    theory = drift_under_j2(RelativeElements(*first), A, 0.108, orbits * 2 * np.pi)
    predicted = np.arctan2(theory.dey, theory.dex) - np.arctan2(first[3], first[2])
    assert abs(np.rad2deg(predicted) / orbits - 1.02) < 0.02  # deg per orbit
    assert abs(turned - predicted) < 0.1 * abs(predicted)


def test_a_burn_changes_the_velocity_by_its_impulse() -> None:
    target, chaser = safety_ellipse()
    start = np.concatenate([*target, *chaser])
    t = np.array([0.0, 4.0])
    push = Burn(1.25, 0.5, (0.0, 0.0, 0.04))
    free, burned = fly(start, t, TWO_BODY), fly(start, t, TWO_BODY, [push])
    np.testing.assert_allclose((burned - free)[1, 9:], [0.0, 0.0, 0.02], atol=1e-7)  # m/s
    np.testing.assert_allclose((burned - free)[1, 8], 0.02 * 2.5, atol=1e-6)  # m


def test_elements_of_a_circle_are_those_it_was_made_from() -> None:
    found = elements(*target_at(0.0, 0.5))
    assert isinstance(found, Elements)
    np.testing.assert_allclose([found.a_m / A, found.u, found.i, found.raan], [1.0, 1.2, 0.108, 0.3], atol=1e-9)


@pytest.mark.parametrize("e", [0.0, 0.02])
def test_the_gradient_transition_follows_motion_under_j2_where_clohessy_wiltshire_cannot(e: float) -> None:
    r, v = target_at(e, 0.4, i=0.9)
    chaser = eci_from_ric(r, v, np.array([10.0, -60.0, 8.0]), np.array([0.0, -2 * N * 10.0, 0.003]))
    t = np.arange(0.0, 1201.0)
    y = fly(np.concatenate([r, v, *chaser]), t, ForceConfig(density_kg_m3=0.0))
    found = np.concatenate(ric_from_eci(y[:, :3], y[:, 3:6], y[:, 6:9], y[:, 9:]), axis=1)
    ephemeris = (t[::30].copy(), np.ascontiguousarray(y[::30, :3]), np.ascontiguousarray(y[::30, 3:6]))
    gradient, circular = found[0], found[0]
    for s in t[:-1]:
        gradient = gradient_transition(*ephemeris, s, 1.0) @ gradient
        circular = cw_transition(float(N), 1.0) @ circular
    assert np.linalg.norm(gradient[:3] - found[-1, :3]) < 0.003  # m after 20 min at 80 m: the neglected rho^2/a
    assert np.linalg.norm(gradient[3:] - found[-1, 3:]) < 5e-6  # m/s
    assert np.linalg.norm(circular[:3] - found[-1, :3]) > 10.0 * np.linalg.norm(gradient[:3] - found[-1, :3])


def test_gravity_gradient_is_the_derivative_of_gravity() -> None:
    r, v = target_at(0.01, 0.7, i=1.1)
    force = ForceConfig(density_kg_m3=0.0)
    columns = [
        (acceleration(r + 10.0 * axis, v, 0.0, force) - acceleration(r - 10.0 * axis, v, 0.0, force)) / 20.0
        for axis in np.eye(3)
    ]
    np.testing.assert_allclose(gravity_gradient(r), np.stack(columns, axis=1), atol=1e-15)  # 1/s^2 of 1e-6
