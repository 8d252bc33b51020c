"""Relative motion against numerical two-body motion and against an outside library."""

import numpy as np
import pytest
from jaxtyping import Float

from navigation.orbits import ELLIPSE_STATE, TWO_BODY, N, target_at
from proxnav.flight.orbit_forces import Burn, ForceConfig, acceleration, fly
from proxnav.geometry.celestial import MU_EARTH
from proxnav.geometry.relative_motion import cw_transition, eci_from_ric, ric_from_eci
from proxnav.navigation.kernels.gravity_gradient import gradient_transition, gravity_gradient


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


def safety_ellipse() -> tuple[tuple[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Target and chaser on a bounded ellipse of 15 m by 12 m across the flight."""
    target = target_at(0.0, 0.0)
    rho = np.array([15.0, 0.0, 12.0])
    return target, eci_from_ric(*target, rho, np.array([0.0, -2 * N * 15.0, 0.0]))


def test_a_burn_changes_the_velocity_by_its_impulse() -> None:
    target, chaser = safety_ellipse()
    start = np.concatenate([*target, *chaser])
    t = np.array([0.0, 4.0])
    push = Burn(1.25, 0.5, (0.0, 0.0, 0.04))
    free, burned = fly(start, t, TWO_BODY), fly(start, t, TWO_BODY, [push])
    np.testing.assert_allclose((burned - free)[1, 9:], [0.0, 0.0, 0.02], atol=1e-7)  # m/s
    np.testing.assert_allclose((burned - free)[1, 8], 0.02 * 2.5, atol=1e-6)  # m


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
