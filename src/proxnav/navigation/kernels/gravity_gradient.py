"""Relative motion along any orbit under Earth's gravity with J2, to first order in the distance."""

import math

import numpy as np

from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, EARTH_J2, MU_EARTH
from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.relative_motion import POSITION, VELOCITY
from proxnav.navigation.kernels.orbit import orbit_at, ric_turning


@kernel
def gravity_gradient(r):
    """d(acceleration)/d(position) in ECI [1/s^2], two-body and J2 (Montenbruck and Gill, eq. 3.32, differentiated)."""
    d2 = r @ r
    d = math.sqrt(d2)
    G = (3.0 * np.outer(r, r) / d2 - np.eye(3)) * (MU_EARTH / (d2 * d))
    k = 1.5 * EARTH_J2 * MU_EARTH * EARTH_EQUATORIAL_RADIUS**2 / (d2 * d2 * d)
    z2 = r[2] * r[2] / d2
    G += k * (5.0 * np.outer(r, r) / d2 * (1.0 - 7.0 * z2) + (5.0 * z2 - 1.0) * np.eye(3))
    for i in range(3):
        G[i, 2] += 10.0 * k * r[i] * r[2] / d2
        G[2, i] += 10.0 * k * r[i] * r[2] / d2
    G[2, 2] -= 2.0 * k
    return G


@kernel
def gradient_transition(times, r, v, t, dt):
    """Phi of (rho, rho_dot) in RIC over dt, a few seconds at most: exact in the frame's turning, gradient at mid-step.

    In ECI axes the relative state obeys rho'' = G rho; T turns it from RIC, where velocities are those of the rotating
    frame: T(t + dt)^-1 exp([[0, I], [G, 0]] dt) T(t).
    """
    _, _, R0, n0 = orbit_at(times, r, v, t)
    middle, _, _, _ = orbit_at(times, r, v, t + 0.5 * dt)
    _, _, R1, n1 = orbit_at(times, r, v, t + dt)
    G, one = gravity_gradient(middle), np.eye(3)
    Phi = np.empty((6, 6))
    Phi[POSITION, POSITION] = Phi[VELOCITY, VELOCITY] = one + 0.5 * dt * dt * G
    Phi[POSITION, VELOCITY] = dt * one + dt**3 / 6.0 * G
    Phi[VELOCITY, POSITION] = dt * G + dt**3 / 6.0 * (G @ G)
    return _from_inertial(R1, n1) @ Phi @ _to_inertial(R0, n0)


@kernel
def _to_inertial(R, n):
    """(rho, rho_dot) in RIC axes R, which turn with n [rad/s], to inertial ones."""
    T = np.zeros((6, 6))
    T[POSITION, POSITION], T[VELOCITY, VELOCITY], T[VELOCITY, POSITION] = R, R, R @ ric_turning(n)
    return T


@kernel
def _from_inertial(R, n):
    """Inverse of `_to_inertial`."""
    T = np.zeros((6, 6))
    T[POSITION, POSITION], T[VELOCITY, VELOCITY], T[VELOCITY, POSITION] = R.T, R.T, -ric_turning(n) @ R.T
    return T
