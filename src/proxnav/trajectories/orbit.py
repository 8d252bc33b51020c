"""The target's circular orbit, two-body."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, MU_EARTH
from proxnav.geometry.types import Vector3


@dataclass(frozen=True)
class OrbitConfig:
    """A circular orbit; the default is Space Rider's."""

    altitude_m: float = 400e3
    """Above Earth's equatorial radius."""
    inclination_deg: float = 6.2
    raan_deg: float = 0.0
    """Right ascension of the ascending node."""
    argument_of_latitude_deg: float = 0.0
    """Angle from the node at t = 0."""

    def __post_init__(self) -> None:
        if not self.altitude_m > 0.0:
            raise InputError(f"altitude_m must be positive, found {self.altitude_m}")

    @property
    def radius_m(self) -> float:
        """Distance from Earth's centre."""
        return EARTH_EQUATORIAL_RADIUS + self.altitude_m

    @property
    def mean_motion(self) -> float:
        """Orbital rate n [rad/s]."""
        return float(np.sqrt(MU_EARTH / self.radius_m**3))

    @property
    def period_s(self) -> float:
        """Time of one revolution."""
        return 2.0 * np.pi / self.mean_motion


def fly_orbit(config: OrbitConfig, t: Float[np.ndarray, "n"]) -> tuple[Vector3, Vector3]:
    """(r, v) in ECI [m, m/s] at seconds `t`.

    >>> r, v = fly_orbit(OrbitConfig(), np.array([0.0]))
    >>> float(np.linalg.norm(v[0]).round(1))
    7668.6
    """
    raan, i = np.deg2rad(config.raan_deg), np.deg2rad(config.inclination_deg)
    u = np.deg2rad(config.argument_of_latitude_deg) + config.mean_motion * t
    node = np.array([np.cos(raan), np.sin(raan), 0.0])
    ahead = np.array([-np.cos(i) * np.sin(raan), np.cos(i) * np.cos(raan), np.sin(i)])
    c, s = np.cos(u)[:, None], np.sin(u)[:, None]
    r = config.radius_m * (c * node + s * ahead)
    return r, config.radius_m * config.mean_motion * (-s * node + c * ahead)
