"""Earth, Sun and Moon as a rendezvous camera needs them, in ECI (J2000 axes, Earth's centre).

Sun and Moon are the Astronomical Almanac's low-precision series (about 0.01 and 0.3 deg), referred to the equinox of
J2000; Earth turns by mean sidereal time and precession (nutation, 0.005 deg, and polar motion are left out).
Formulas: O. Montenbruck, E. Gill, "Satellite Orbits", 2000 (M&G); D. Vallado, "Fundamentals of Astrodynamics", 2013.
"""

import numpy as np

from proxnav.geometry import quaternion
from proxnav.geometry.arrays import unit
from proxnav.geometry.epochs import Times, days_since_j2000
from proxnav.geometry.types import QuatWxyz, Rotation3x3, Vector3

MU_EARTH = 3.986004418e14  # m^3/s^2, WGS-84
EARTH_EQUATORIAL_RADIUS = 6378137.0  # m, WGS-84
EARTH_FLATTENING = 1.0 / 298.257223563  # WGS-84
EARTH_POLAR_RADIUS = 6356752.314245  # m, WGS-84
EARTH_MEAN_RADIUS = 6371008.8  # m, IUGG R1 = (2a + b)/3 of GRS-80
EARTH_J2 = 1.08262668e-3  # EGM96, unnormalised
EARTH_RATE = 7.292115e-5  # rad/s, WGS-84, inertial
ASTRONOMICAL_UNIT = 1.495978707e11  # m, IAU 2012
SUN_RADIUS = 6.957e8  # m, IAU 2015 nominal
SUN_HALF_ANGLE = 4.65e-3  # rad, mean angular radius of the Sun seen from 1 au

_OBLIQUITY = np.deg2rad(23.43929111)  # of J2000
_PRECESSION_DEG_PER_CENTURY = 1.3972  # general precession in longitude, moves the equinox of date back to J2000
_CENTURY_DAYS = 36525.0

_MOON_LONGITUDE = (  # amplitude [deg], phase [deg], rate [deg/century]; Vallado, algorithm 31
    (6.29, 134.9, 477198.85),
    (-1.27, 259.2, -413335.38),
    (0.66, 235.7, 890534.23),
    (0.21, 269.9, 954397.70),
    (-0.19, 357.5, 35999.05),
    (-0.11, 186.6, 966404.05),
)
_MOON_LATITUDE = ((5.13, 93.3, 483202.03), (0.28, 228.2, 960400.87), (-0.28, 318.3, 6003.18), (-0.17, 217.6, -407332.2))


def sun_direction_eci(epoch_utc: str, t: Times) -> Vector3:
    """Unit vectors from Earth's centre to the Sun, in ECI.

    >>> sun_direction_eci("2024-12-21T09:20:00Z", np.array(0.0)).round(3)  # winter solstice
    array([-0.006, -0.917, -0.398])
    """
    days = days_since_j2000(epoch_utc, t)
    g = _sun_anomaly(days)
    of_date = 280.460 + 0.9856474 * days + 1.915 * np.sin(g) + 0.020 * np.sin(2.0 * g)
    return _ecliptic_to_eci(_to_j2000(of_date, days), np.zeros_like(g))


def sun_distance_m(epoch_utc: str, t: Times) -> Times:
    """Distance from Earth to the Sun [m]."""
    g = _sun_anomaly(days_since_j2000(epoch_utc, t))
    return ASTRONOMICAL_UNIT * (1.00014 - 0.01671 * np.cos(g) - 0.00014 * np.cos(2.0 * g))


def moon_direction_eci(epoch_utc: str, t: Times) -> Vector3:
    """Unit vectors from Earth's centre to the Moon, in ECI."""
    days = days_since_j2000(epoch_utc, t)
    centuries = days / _CENTURY_DAYS
    of_date = 218.32 + 481267.8813 * centuries + _series(_MOON_LONGITUDE, centuries)
    latitude = _series(_MOON_LATITUDE, centuries)
    return _ecliptic_to_eci(_to_j2000(of_date, days), np.deg2rad(latitude))


def gmst(epoch_utc: str, t: Times) -> Times:
    """Greenwich mean sidereal time [rad] in [0, 2 pi), with UT1 taken as UTC (Vallado, eq. 3-47)."""
    days = days_since_j2000(epoch_utc, t)
    centuries = days / _CENTURY_DAYS
    # The day's own turn is reduced first: 360 deg times 1e4 days would cost four digits.
    degrees = 280.46061837 + 360.0 * np.mod(days, 1.0) + 0.98564736629 * days + 0.000387933 * centuries**2
    return np.mod(np.deg2rad(degrees), 2.0 * np.pi)


def q_eci_ecef(epoch_utc: str, t: Times) -> QuatWxyz:
    """Earth-fixed axes to ECI: sidereal rotation about the pole of date, then precession back to J2000."""
    return quaternion.multiply(q_eci_mod(epoch_utc, t), _turn(2, gmst(epoch_utc, t)))


def q_eci_mod(epoch_utc: str, t: Times) -> QuatWxyz:
    """Mean equator and equinox of date to ECI (IAU 1976 precession, M&G eq. 5.45 to 5.48)."""
    T = days_since_j2000(epoch_utc, t) / _CENTURY_DAYS
    arcsec = np.pi / 648000.0
    zeta = (2306.2181 * T + 0.30188 * T**2 + 0.017998 * T**3) * arcsec
    theta = (2004.3109 * T - 0.42665 * T**2 - 0.041833 * T**3) * arcsec
    z = zeta + (0.79280 * T**2 + 0.000205 * T**3) * arcsec
    return quaternion.multiply(quaternion.multiply(_turn(2, -zeta), _turn(1, theta)), _turn(2, -z))


def geodetic_to_ecef(latitude: Times, longitude: Times, altitude_m: Times) -> Vector3:
    """Earth-fixed positions [m] of geodetic latitude and longitude [rad] on the WGS-84 ellipsoid (M&G eq. 5.83)."""
    e2 = EARTH_FLATTENING * (2.0 - EARTH_FLATTENING)
    N = EARTH_EQUATORIAL_RADIUS / np.sqrt(1.0 - e2 * np.sin(latitude) ** 2)
    across = (N + altitude_m) * np.cos(latitude)
    z = ((1.0 - e2) * N + altitude_m) * np.sin(latitude)
    return np.stack([across * np.cos(longitude), across * np.sin(longitude), z], axis=-1)


def sun_visible_fraction(r_eci_m: Vector3, sun_eci: Vector3, sun_distance_m: float = ASTRONOMICAL_UNIT) -> Times:
    """Share of the Sun's disc seen past a spherical Earth: 1 in sunlight, 0 in umbra, between them in penumbra.

    Overlap of two discs (M&G eq. 3.85 to 3.92); `sun_eci` is the unit vector from Earth to the Sun.
    """
    to_sun = sun_distance_m * sun_eci - r_eci_m
    distance = np.linalg.norm(to_sun, axis=-1)
    radius = np.linalg.norm(r_eci_m, axis=-1)
    a = np.arcsin(np.clip(SUN_RADIUS / distance, 0.0, 1.0))
    b = np.arcsin(np.clip(EARTH_EQUATORIAL_RADIUS / radius, 0.0, 1.0))
    cosine = -np.sum(r_eci_m * to_sun, axis=-1) / (radius * distance)
    return 1.0 - _disc_overlap(a, b, np.arccos(np.clip(cosine, -1.0, 1.0)))


def R_eci_ric(r_eci_m: Vector3, v_eci_mps: Vector3) -> Rotation3x3:
    """Radial, in-track, cross-track axes as columns: x outward, y along the motion, z along r x v."""
    x = unit(r_eci_m)
    z = unit(np.cross(r_eci_m, v_eci_mps))
    return np.stack([x, np.cross(z, x), z], axis=-1)


def R_eci_lvlh(r_eci_m: Vector3, v_eci_mps: Vector3) -> Rotation3x3:
    """Local-vertical, local-horizontal axes as columns: x forward, y against the orbit's normal, z to nadir."""
    ric = R_eci_ric(r_eci_m, v_eci_mps)
    return np.stack([ric[..., 1], -ric[..., 2], -ric[..., 0]], axis=-1)


def _sun_anomaly(days: Times) -> Times:
    return np.deg2rad(357.528 + 0.9856003 * days)


def _to_j2000(longitude_deg: Times, days: Times) -> Times:
    return np.deg2rad(longitude_deg - _PRECESSION_DEG_PER_CENTURY * days / _CENTURY_DAYS)


def _series(terms: tuple[tuple[float, float, float], ...], centuries: Times) -> Times:
    waves = [amplitude * np.sin(np.deg2rad(phase + rate * centuries)) for amplitude, phase, rate in terms]
    return np.sum(waves, axis=0)


def _ecliptic_to_eci(longitude: Times, latitude: Times) -> Vector3:
    x = np.cos(latitude) * np.cos(longitude)
    y = np.cos(latitude) * np.sin(longitude)
    z = np.sin(latitude)
    ce, se = np.cos(_OBLIQUITY), np.sin(_OBLIQUITY)
    return np.stack([x, ce * y - se * z, se * y + ce * z], axis=-1)


def _turn(axis: int, angle: Times) -> QuatWxyz:
    """Active rotation by `angle` [rad] about one axis."""
    return quaternion.exp(np.asarray(angle)[..., None] * np.eye(3)[axis])


def _disc_overlap(a: Times, b: Times, c: Times) -> Times:
    """Share of the disc of radius a that a disc of radius b covers, their centres c apart."""
    safe_c = np.where(c > 0.0, c, 1.0)
    x = np.clip((c**2 + a**2 - b**2) / (2.0 * safe_c), -a, a)
    y = np.sqrt(np.maximum(a**2 - x**2, 0.0))
    far = np.arccos(np.clip((c - x) / b, -1.0, 1.0))
    share = (a**2 * np.arccos(np.clip(x / a, -1.0, 1.0)) + b**2 * far - c * y) / (np.pi * a**2)
    share = np.where(c >= a + b, 0.0, np.where(c <= b - a, 1.0, np.where(c <= a - b, (b / a) ** 2, share)))
    return np.clip(share, 0.0, 1.0)
