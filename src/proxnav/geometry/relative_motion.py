"""Motion of the chaser relative to the target, in RIC: x radial outward, y in-track, z cross-track along r x v.

Clohessy and Wiltshire, "Terminal guidance system for satellite rendezvous", J. Aerospace Sciences 27(9), 1960;
valid on circular orbits, with an error of about rho^2 / a (1.5 mm at 100 m and 400 km).
"""

import numpy as np
from jaxtyping import Float

from proxnav.geometry.celestial import R_eci_ric
from proxnav.geometry.types import Rotation3x3, Vector3

POSITION, VELOCITY = slice(0, 3), slice(3, 6)
"""Blocks of a relative state (rho [m], rho_dot [m/s]), and of its transition."""


def cw_transition(n: float, dt: float) -> Float[np.ndarray, "6 6"]:
    """Phi with (rho, rho_dot)(t + dt) = Phi (rho, rho_dot)(t), for the mean motion n [rad/s]."""
    s, c, nt = np.sin(n * dt), np.cos(n * dt), n * dt
    rr = [[4 - 3 * c, 0, 0], [6 * (s - nt), 1, 0], [0, 0, c]]
    rv = [[s / n, 2 * (1 - c) / n, 0], [-2 * (1 - c) / n, (4 * s - 3 * nt) / n, 0], [0, 0, s / n]]
    vr = [[3 * n * s, 0, 0], [-6 * n * (1 - c), 0, 0], [0, 0, -n * s]]
    vv = [[c, 2 * s, 0], [-2 * s, 4 * c - 3, 0], [0, 0, c]]
    return np.block([[np.array(rr), np.array(rv)], [np.array(vr), np.array(vv)]])


def eci_from_ric(
    r_target: Vector3, v_target: Vector3, rho_ric: Vector3, rho_dot_ric: Vector3
) -> tuple[Vector3, Vector3]:
    """(r, v) of the chaser in ECI from its position and its rates in the target's rotating RIC frame."""
    R = R_eci_ric(r_target, v_target)
    rate = ric_rate(r_target, v_target)
    r = r_target + _turn(R, rho_ric)
    return r, v_target + _turn(R, rho_dot_ric + np.cross(rate, rho_ric))


def ric_from_eci(r_target: Vector3, v_target: Vector3, r_chaser: Vector3, v_chaser: Vector3) -> tuple[Vector3, Vector3]:
    """Inverse of `eci_from_ric`: (rho, rho_dot) in RIC."""
    R_ric_eci = np.swapaxes(R_eci_ric(r_target, v_target), -1, -2)
    rho = _turn(R_ric_eci, r_chaser - r_target)
    return rho, _turn(R_ric_eci, v_chaser - v_target) - np.cross(ric_rate(r_target, v_target), rho)


def ric_rate(r_target: Vector3, v_target: Vector3) -> Vector3:
    """Inertial rate of the RIC frame in its own axes [rad/s], the normal's slow drift left out."""
    rate = np.linalg.norm(np.cross(r_target, v_target), axis=-1) / np.sum(r_target**2, axis=-1)
    return np.asarray(rate)[..., None] * np.array([0.0, 0.0, 1.0])


def _turn(R: Rotation3x3, v: Vector3) -> Vector3:
    return (R @ v[..., None])[..., 0]
