"""Orbits that several tests fly."""

import numpy as np

from proxnav.flight.orbit_forces import ForceConfig
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, MU_EARTH

TWO_BODY = ForceConfig(j2=False, density_kg_m3=0.0)
A = EARTH_EQUATORIAL_RADIUS + 400e3  # m
N = np.sqrt(MU_EARTH / A**3)
ELLIPSE_STATE = (np.array([15.0, -40.0, 12.0]), np.array([0.002, -2 * N * 15.0, -0.004]))  # m, m/s in RIC


def target_at(
    e: float, nu: float, i: float = 0.108, raan: float = 0.3, perigee: float = 0.7
) -> tuple[np.ndarray, np.ndarray]:
    p = A * (1.0 - e * e)
    r = p / (1.0 + e * np.cos(nu))
    u = perigee + nu
    node = np.array([np.cos(raan), np.sin(raan), 0.0])
    ahead = np.array([-np.cos(i) * np.sin(raan), np.cos(i) * np.cos(raan), np.sin(i)])
    at = np.cos(u) * node + np.sin(u) * ahead
    across = -np.sin(u) * node + np.cos(u) * ahead
    speed = np.sqrt(MU_EARTH / p)
    return r * at, speed * (e * np.sin(nu) * at + (1.0 + e * np.cos(nu)) * across)
