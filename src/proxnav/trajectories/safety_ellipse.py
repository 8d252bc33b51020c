"""The walking safety ellipse: a spiral with elliptical base, drifting along-track past the target.

In RIC, with chi = n t + chi0 (A. Gili, MSc thesis, Politecnico di Torino, 2023; ydot with + ydot_c, which the
Clohessy-Wiltshire equations demand and the thesis misprints):

    x = x_max sin chi - 2 ydot_c / (3 n)      y = 2 x_max cos chi + ydot_c t + y_c      z = z_max cos chi

y and z are in phase, so the path never crosses the V-bar axis: passively safe while it drifts.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import Vector3
from proxnav.records import Trajectory
from proxnav.trajectories.generators import FlightConfig, fly_relative, time_grid


@dataclass(frozen=True)
class SafetyEllipseConfig:
    """Size, place and drift of the spiral; the default passes the target at 11 m to 116 m in four orbits."""

    x_max_m: float = 15.0
    """Radial amplitude; the in-track one is twice as large."""
    z_max_m: float = 15.0
    """Cross-track amplitude."""
    y_c_m: float = -85.0
    """In-track centre at t = 0."""
    ydot_c_mps: float = 7.65e-3
    """In-track drift."""
    chi0_deg: float = 0.0
    """Phase at t = 0."""
    orbits: float = 4.0
    """Duration in revolutions of the target."""
    step_s: float = 10.0


OBSERVATION_10_100 = SafetyEllipseConfig()
"""Nominal: 11.1 m to 116 m, clearance 10.5 m to the V-bar; clip by range, or use the strict one."""
OBSERVATION_10_100_STRICT = SafetyEllipseConfig(x_max_m=14.0, z_max_m=14.0, y_c_m=-70.0, ydot_c_mps=6.30e-3)
"""Strictly below 100 m: 10.6 m to 99.1 m."""
SROC_200_350 = SafetyEllipseConfig(
    x_max_m=250.0, z_max_m=200.0, y_c_m=-300.0, ydot_c_mps=600.0 / 28800.0, orbits=28800.0 / 5553.6
)
"""The flown observation of SROC: 600 m of drift in 8 h, outside the 200 m keep-out sphere."""


def walking_safety_ellipse(
    config: SafetyEllipseConfig = OBSERVATION_10_100, flight: FlightConfig | None = None
) -> Trajectory:
    """The spiral as a trajectory.

    >>> trajectory = walking_safety_ellipse()
    >>> float(trajectory.range_m.min().round(1)), float(trajectory.range_m.max().round(0))
    (11.1, 116.0)
    """
    flight = flight or FlightConfig()
    t = time_grid(config.orbits * flight.orbit.period_s, config.step_s)
    rho, rho_dot = ellipse_state(config, flight.orbit.mean_motion, t)
    return fly_relative(t, rho, rho_dot, flight, "walking safety ellipse")


def ellipse_state(config: SafetyEllipseConfig, n: float, t: Float[np.ndarray, "n"]) -> tuple[Vector3, Vector3]:
    """(rho, rho_dot) in RIC [m, m/s] at seconds `t`, for the mean motion `n` [rad/s]."""
    chi = n * t + np.deg2rad(config.chi0_deg)
    s, c = np.sin(chi), np.cos(chi)
    x = config.x_max_m * s + radial_centre_m(config, n)
    y = 2.0 * config.x_max_m * c + config.ydot_c_mps * t + config.y_c_m
    z = config.z_max_m * c
    xdot = config.x_max_m * n * c
    ydot = -2.0 * config.x_max_m * n * s + config.ydot_c_mps
    zdot = -config.z_max_m * n * s
    return np.stack([x, y, z], axis=-1), np.stack([xdot, ydot, zdot], axis=-1)


def radial_centre_m(config: SafetyEllipseConfig, n: float) -> float:
    """x_c = -2 ydot_c / (3 n), the radial offset that makes the centre drift at ydot_c."""
    return -2.0 * config.ydot_c_mps / (3.0 * n)
