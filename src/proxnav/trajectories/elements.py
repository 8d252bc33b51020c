"""An orbit in one line of classical elements, and its two-body motion."""

import re
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, MU_EARTH
from proxnav.geometry.types import Vector3
from proxnav.trajectories.readers.units import LENGTH

_ITEM = re.compile(r"(?P<key>[A-Za-z]+)\s*=\s*(?P<value>[-+0-9.eE]+)(?:\s*(?P<unit>[A-Za-z]+)(?!\s*=|[A-Za-z]))?")
_PLACES = ("nu", "M", "u")
_ANGLES = {"i": "i", "raan": "raan", "argp": "argp"}
EXAMPLE = "a=6778.137km e=0.001 i=51.6 raan=30 argp=0 nu=10"
_KEPLER_STEPS = 50


@dataclass(frozen=True, slots=True)
class ClassicalElements:
    """An ellipse about Earth at t = 0, in ECI."""

    a_m: float
    """Semi-major axis."""
    e: float
    i_rad: float
    raan_rad: float
    argp_rad: float
    """Argument of perigee; 0 where the ellipse is a circle."""
    M_rad: float
    """Mean anomaly at t = 0."""

    @property
    def mean_motion(self) -> float:
        """Mean rate n [rad/s]."""
        return float(np.sqrt(MU_EARTH / self.a_m**3))


def parse_elements(text: str) -> ClassicalElements:
    """Elements of one line, angles in degrees.

    Keys: `a` or `alt` (above the equator) with m or km; `e`, `i`, `raan`, `argp`; `nu` (true anomaly), `M` (mean) or
    `u` (argument of latitude). What is absent is 0, but for the size. InputError says what is wrong with it.

    >>> parse_elements("alt=400km i=51.6").a_m
    6778137.0
    """
    found = {match["key"] if match["key"] in _PLACES else match["key"].lower(): match for match in _ITEM.finditer(text)}
    rest = _ITEM.sub("", text).replace(",", "").strip()
    unknown = sorted(set(found) - {"a", "alt", "e", *_ANGLES, *_PLACES})
    if rest or unknown or not found:
        raise InputError(f"orbit '{text}': '{rest or ', '.join(unknown)}' is no element; write it like {EXAMPLE}")
    if ("a" in found) == ("alt" in found):
        raise InputError(f"orbit '{text}': give the size once, as a= or alt=; write it like {EXAMPLE}")
    if len(places := [key for key in _PLACES if key in found]) > 1:
        raise InputError(f"orbit '{text}': {' and '.join(places)} both say where the craft is; give one")
    values = {key: _number(text, match) for key, match in found.items()}
    e, argp = values.get("e", 0.0), np.deg2rad(values.get("argp", 0.0))
    a = _length(text, found["a"]) if "a" in found else EARTH_EQUATORIAL_RADIUS + _length(text, found["alt"])
    if not (0.0 <= e < 1.0 and a * (1.0 - e) > 0.98 * EARTH_EQUATORIAL_RADIUS):
        raise InputError(
            f"orbit '{text}': e = {e:g} and a perigee {a * (1.0 - e) / 1e3:.6g} km from Earth's centre; "
            "an orbit needs 0 <= e < 1 and a perigee above ground: check the unit of the size"
        )
    return ClassicalElements(
        a,
        e,
        np.deg2rad(values.get("i", 0.0)),
        np.deg2rad(values.get("raan", 0.0)),
        argp,
        _mean_anomaly(values, e, argp),
    )


def fly_elements(elements: ClassicalElements, t: Float[np.ndarray, "n"]) -> tuple[Vector3, Vector3]:
    """(r, v) in ECI [m, m/s] at seconds `t` (Vallado, algorithm 10)."""
    a, e, n = elements.a_m, elements.e, elements.mean_motion
    E = _eccentric_anomaly(elements.M_rad + n * t, e)
    c, s, b = np.cos(E), np.sin(E), np.sqrt(1.0 - e**2)
    rate = n / (1.0 - e * c)
    P, Q = _perifocal_axes(elements)
    r = a * ((c - e)[:, None] * P + (b * s)[:, None] * Q)
    return r, a * rate[:, None] * (-s[:, None] * P + (b * c)[:, None] * Q)


def _perifocal_axes(x: ClassicalElements) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Unit vectors to perigee and a quarter turn ahead."""
    co, so, ci, si = np.cos(x.raan_rad), np.sin(x.raan_rad), np.cos(x.i_rad), np.sin(x.i_rad)
    node, ahead = np.array([co, so, 0.0]), np.array([-so * ci, co * ci, si])
    cw, sw = np.cos(x.argp_rad), np.sin(x.argp_rad)
    return cw * node + sw * ahead, -sw * node + cw * ahead


def _eccentric_anomaly(M: Float[np.ndarray, "n"], e: float) -> Float[np.ndarray, "n"]:
    """Kepler's equation M = E - e sin E, by Newton's steps."""
    E = M + e * np.sin(M)
    for _ in range(_KEPLER_STEPS):
        step = (E - e * np.sin(E) - M) / (1.0 - e * np.cos(E))
        E = E - step
        if np.abs(step).max(initial=0.0) < 1e-14:
            break
    return E


def _mean_anomaly(values: dict[str, float], e: float, argp: float) -> float:
    if "M" in values:
        return float(np.deg2rad(values["M"]))
    nu = np.deg2rad(values.get("nu", 0.0)) if "u" not in values else np.deg2rad(values["u"]) - argp
    E = 2.0 * np.arctan2(np.sqrt(1.0 - e) * np.sin(nu / 2.0), np.sqrt(1.0 + e) * np.cos(nu / 2.0))
    return float(E - e * np.sin(E))


def _number(text: str, match: re.Match[str]) -> float:
    try:
        value = float(match["value"])
    except ValueError:
        value = np.nan
    if not np.isfinite(value) or (match["unit"] and match["key"] not in ("a", "alt") and match["unit"] != "deg"):
        raise InputError(f"orbit '{text}': {match[0]} is no element; write it like {EXAMPLE}, angles in degrees")
    return value


def _length(text: str, match: re.Match[str]) -> float:
    if (match["unit"] or "").lower() not in LENGTH:
        raise InputError(f"orbit '{text}': {match[0]} needs a unit, m or km; write it like {EXAMPLE}")
    return float(match["value"]) * LENGTH[match["unit"].lower()]
