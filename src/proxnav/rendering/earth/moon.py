"""The Moon: where it stands at an epoch and how bright its face is."""

import math
from datetime import UTC, datetime

import numpy as np

from proxnav.geometry import quaternion
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS
from proxnav.geometry.compiled.kernel import fast_kernel
from proxnav.geometry.types import Vector3
from proxnav.records import SceneSpec

RADIUS_M = 1_737.4e3  # m
ALBEDO = np.array([0.140, 0.120, 0.100])  # geometric, in the three bands


def position_eci_m(epoch_utc: str, t: float) -> Vector3:
    """Geocentric position [m] to 0.3 deg: low-precision formulas of the Astronomical Almanac, page D22."""
    moment = datetime.fromisoformat(epoch_utc.replace("Z", "+00:00"))
    moment = moment if moment.tzinfo else moment.replace(tzinfo=UTC)
    days = (moment - datetime(2000, 1, 1, 12, tzinfo=UTC)).total_seconds() + t
    c = days / 86400.0 / 36525.0

    def sin(a: float, b: float) -> float:
        return math.sin(math.radians(a + b * c))

    def cos(a: float, b: float) -> float:
        return math.cos(math.radians(a + b * c))

    lon = 218.32 + 481267.881 * c + 6.29 * sin(135.0, 477198.87) - 1.27 * sin(259.3, -413335.36)
    lon += 0.66 * sin(235.7, 890534.22) + 0.21 * sin(269.9, 954397.74)
    lon += -0.19 * sin(357.5, 35999.05) - 0.11 * sin(186.5, 966404.03)
    lat = 5.13 * sin(93.3, 483202.02) + 0.28 * sin(228.2, 960400.89)
    lat += -0.28 * sin(318.3, 6003.15) - 0.17 * sin(217.6, -407332.21)
    parallax = 0.9508 + 0.0518 * cos(135.0, 477198.87) + 0.0095 * cos(259.3, -413335.36)
    parallax += 0.0078 * cos(235.7, 890534.22) + 0.0028 * cos(269.9, 954397.74)
    r = EARTH_EQUATORIAL_RADIUS / math.sin(math.radians(parallax))
    lon_rad, lat_rad, tilt = math.radians(lon), math.radians(lat), math.radians(23.439)
    x, y, z = math.cos(lat_rad) * math.cos(lon_rad), math.cos(lat_rad) * math.sin(lon_rad), math.sin(lat_rad)
    return r * np.array([x, math.cos(tilt) * y - math.sin(tilt) * z, math.sin(tilt) * y + math.cos(tilt) * z])


def seen_from(scene: SceneSpec, r_earth_eye_target_m: Vector3) -> tuple[Vector3, float]:
    """Unit direction in target axes and angular radius [rad] for an eye given from Earth's centre; 0 without epoch."""
    if not scene.epoch_utc:
        return np.array([0.0, 0.0, 1.0]), 0.0
    r = quaternion.rotate(np.array(scene.q_target_eci), position_eci_m(scene.epoch_utc, scene.t)) - r_earth_eye_target_m
    distance = float(np.linalg.norm(r))
    return r / distance, math.asin(RADIUS_M / distance)


@fast_kernel
def disc(ray, to_moon, to_sun, half_angle, band):
    """Radiance per unit Sun irradiance [1/sr] of the Moon's face down a unit ray; 0 beside it.

    Lommel-Seeliger reflection, which has no limb darkening at full Moon; unit vectors are tuples.
    """
    nu = ray[0] * to_moon[0] + ray[1] * to_moon[1] + ray[2] * to_moon[2]
    across2 = (1.0 - nu * nu) / math.sin(half_angle) ** 2
    if nu <= 0.0 or across2 >= 1.0:
        return 0.0
    mu = math.sqrt(1.0 - across2)
    lit = 0.0
    for k in range(3):
        normal = (ray[k] - nu * to_moon[k]) / math.sin(half_angle) - mu * to_moon[k]
        lit += normal * to_sun[k]
    return 0.0 if lit <= 0.0 else 2.0 * ALBEDO[band] / math.pi * lit / (lit + mu)
