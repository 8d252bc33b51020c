"""Cross-sections of the lifting body: flat belly, rounded chines, round leeside, blunt nose, boat-tail."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.interpolate import PchipInterpolator

from proxnav.targets.space_rider.params import SpaceRiderParams

N_BELLY, N_CHINE = 7, 6
DOOR_ANGLE = np.radians(41.0)
"""Where on the leeside the cargo doors begin; 0 is the chine, 90 deg the top."""
SEAM = np.radians(1.6)
MARK_ANGLES = (np.radians(9.0), np.radians(30.0))
SEAM_M = 0.035
"""Width of the gap about the doors along x."""

_LEE = np.radians(np.linspace(0.0, 90.0, 19))
_FIXED = np.array([DOOR_ANGLE - SEAM, DOOR_ANGLE, *MARK_ANGLES])
LEE_ANGLES = np.sort(np.concatenate([[a for a in _LEE if np.abs(a - _FIXED).min() > np.radians(1.3)], _FIXED]))

# Distance from the nose tip as a share of the body's length -> shares of half width, belly depth and top height.
# The square root of the distance is the spline's argument: it makes the nose blunt.
_S = np.array([0.0, 0.010, 0.035, 0.087, 0.20, 0.42, 0.68, 0.87, 1.0])
_WIDTH = np.array([0.0, 0.245, 0.445, 0.591, 0.73, 0.87, 0.965, 1.0, 0.985])
_BELLY = np.array([0.0, 0.44, 0.70, 0.84, 0.955, 1.0, 1.0, 0.985, 0.90])
_TOP = np.array([0.0, 0.34, 0.54, 0.685, 0.84, 0.955, 1.0, 0.985, 0.86])
_FLAT = np.array([0.05, 0.12, 0.22, 0.36, 0.58, 0.74, 0.82, 0.86, 0.86])
"""Share of the half width that the flat belly takes."""


@dataclass(frozen=True, slots=True, eq=False)
class Sections:
    """Rings of the lifting body from nose to base; ring index runs belly centre, right side, top, left side."""

    distance_m: Float[np.ndarray, "n_stations"]
    """From the nose tip."""
    points_m: Float[np.ndarray, "n_stations n_ring 3"]
    """In the target frame."""
    zone: Int[np.ndarray, "n_ring"]
    """Zone of the strip between ring points j and j + 1: 0 belly, 1 chine, 2 side, 3 door seam, 4 doors, 5 marking."""
    right: Bool[np.ndarray, "n_ring"]
    """Whether that strip is on the right (+y)."""


def body_sections(p: SpaceRiderParams) -> Sections:
    """Stations dense at the blunt nose, plus those where doors, marking and nose cap begin and end."""
    distance = _stations(p)
    half = np.array([_half_section(p, d) for d in distance])
    left = half[:, -2:0:-1] * [1.0, -1.0, 1.0]
    zone = np.concatenate([np.zeros(N_BELLY - 1), np.ones(N_CHINE), _lee_zones()]).astype(np.int64)
    right = np.concatenate([np.ones(len(zone), dtype=bool), np.zeros(len(zone), dtype=bool)])
    return Sections(distance, np.concatenate([half, left], axis=1), np.concatenate([zone, zone[::-1]]), right)


def mark_range_m(p: SpaceRiderParams) -> tuple[float, float]:
    """Front and rear edge of the marking on the body's side, from the nose tip."""
    return 0.60 * p.body_length_m, 0.80 * p.body_length_m


def _stations(p: SpaceRiderParams) -> Float[np.ndarray, "n_stations"]:
    keys = [p.nose_cap_depth_m, p.door_fore_m, p.door_fore_m + SEAM_M, p.door_aft_m - SEAM_M, p.door_aft_m]
    keys = np.array([*keys, *mark_range_m(p), p.body_length_m])
    free = p.body_length_m * np.linspace(0.03, 1.0, 42) ** 2
    apart = np.abs(free[:, None] - keys).min(axis=1) > 0.02
    return np.sort(np.concatenate([free[apart], keys]))


def _half_section(p: SpaceRiderParams, distance_m: float) -> Float[np.ndarray, "n_half 3"]:
    """Right half of one ring, from the belly's centre line to the top."""
    s = np.sqrt(distance_m / p.body_length_m)
    width, belly, top, flat = (
        float(PchipInterpolator(np.sqrt(_S), table)(s)) for table in (_width_table(p), _BELLY, _TOP, _FLAT)
    )
    w = width * p.body_width_m / 2
    z_belly = p.nose_drop_m + belly * (p.body_height_m / 2 - p.nose_drop_m)
    z_top = p.nose_drop_m - top * (p.body_height_m / 2 + p.nose_drop_m)
    chine = min(w * (1 - flat), 0.55 * (z_belly - z_top))
    y, z = _profile(w, w * flat, z_belly, chine, z_top)
    return np.stack([np.full_like(y, p.nose_x_m - distance_m), y, z], axis=1)


Line = Float[np.ndarray, "n_half"]


def _profile(w: float, flat: float, z_belly: float, chine: float, z_top: float) -> tuple[Line, Line]:
    """Belly line, elliptic chine, super-elliptic leeside (exponent 2.3: fuller than an ellipse)."""
    z_side = z_belly - chine
    a = np.linspace(0.0, np.pi / 2, N_CHINE + 1)[1:]
    lee = LEE_ANGLES[1:]
    y_lee = w * np.maximum(np.cos(lee), 0.0) ** (2 / 2.3)
    y_lee[-1] = 0.0
    z_lee = z_side + (z_top - z_side) * np.sin(lee) ** (2 / 2.3)
    y = np.concatenate([np.linspace(0.0, flat, N_BELLY), flat + (w - flat) * np.sin(a), y_lee])
    z = np.concatenate([np.full(N_BELLY, z_belly), z_side + chine * np.cos(a), z_lee])
    return y, z


def _width_table(p: SpaceRiderParams) -> Float[np.ndarray, "n"]:
    """The width shares, with the dome's rim pinned to its diameter."""
    table = _WIDTH.copy()
    rim = np.searchsorted(_S, 0.087)
    table[1 : rim + 1] *= p.nose_cap_diameter_m / p.body_width_m / table[rim]
    return table


def _lee_zones() -> Int[np.ndarray, "n"]:
    middle = (LEE_ANGLES[:-1] + LEE_ANGLES[1:]) / 2
    zone = np.full(len(middle), 2)
    zone[middle > DOOR_ANGLE - SEAM] = 3
    zone[middle > DOOR_ANGLE] = 4
    zone[(middle > MARK_ANGLES[0]) & (middle < MARK_ANGLES[1])] = 5
    return zone
