"""What pulls on two craft in low orbit, integrated together: Earth with J2, drag, the chaser's burns."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from jaxtyping import Float

from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, EARTH_J2, EARTH_RATE, MU_EARTH
from proxnav.geometry.relative_motion import POSITION, VELOCITY
from proxnav.geometry.types import Vector3

Pair = Float[np.ndarray, "12"]
"""States of target and chaser in ECI [m, m/s]."""
R_TARGET, V_TARGET, R_CHASER, V_CHASER = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12)
"""Places in a `Pair`."""

TARGET_DRAG = 3.6e-3
"""Cd A / m of the target [m^2/kg]: 2.2 * 8 m^2 / 4900 kg."""
CHASER_DRAG = 5.5e-3
"""Cd A / m of the chaser [m^2/kg]: 2.2 * 0.06 m^2 / 24 kg."""
_DENSITY_ALTITUDE_M, _SCALE_HEIGHT_M = 400e3, 60e3
"""Air at the altitude of both craft, and how it thins."""
_RTOL, _ATOL = 1e-12, 1e-6
"""Tolerances of the integrator (DOP853): rounding stays below a micrometre over a revolution."""


@dataclass(frozen=True)
class ForceConfig:
    """The true forces; a filter that knows them would be testing itself."""

    j2: bool = True
    density_kg_m3: float = 4e-12
    """Density of the air at 400 km, which turns with Earth."""


@dataclass(frozen=True)
class Burn:
    """Constant thrust acceleration of the chaser, fixed in inertial space."""

    start_s: float
    duration_s: float
    acceleration_eci: tuple[float, float, float]
    """[m/s^2]."""

    @property
    def end_s(self) -> float:
        """When the thruster closes."""
        return self.start_s + self.duration_s


def acceleration(r: Vector3, v: Vector3, drag_m2_per_kg: float, config: ForceConfig) -> Vector3:
    """Acceleration [m/s^2] of one craft in ECI, thrust left out; batches lead."""
    radius2 = np.sum(r * r, axis=-1, keepdims=True)
    radius = np.sqrt(radius2)
    total = -MU_EARTH * r / (radius2 * radius)
    if config.j2:
        total = total + _j2(r, radius2, radius)
    return total + drag(r, v, drag_m2_per_kg, config)


def drag(r: Vector3, v: Vector3, drag_m2_per_kg: float, config: ForceConfig) -> Vector3:
    """Deceleration by air that turns with Earth, exponential in altitude [m/s^2]."""
    altitude = np.sqrt(np.sum(r * r, axis=-1, keepdims=True)) - EARTH_EQUATORIAL_RADIUS
    density = config.density_kg_m3 * np.exp(-(altitude - _DENSITY_ALTITUDE_M) / _SCALE_HEIGHT_M)
    wind = v - EARTH_RATE * np.stack([-r[..., 1], r[..., 0], np.zeros_like(r[..., 0])], axis=-1)
    return -0.5 * drag_m2_per_kg * density * np.sqrt(np.sum(wind * wind, axis=-1, keepdims=True)) * wind


def fly(
    start: Pair, t: Float[np.ndarray, "n"], config: ForceConfig, burns: Sequence[Burn] = ()
) -> Float[np.ndarray, "n 12"]:
    """States of both craft at increasing instants `t` from `start` at t[0]; the chaser's burns are in time order."""
    out = np.empty((len(t), 12))
    now, state, k = float(t[0]), np.asarray(start, dtype=np.float64), 0
    for stop, thrust in _arcs(float(t[0]), float(t[-1]), burns):
        until = len(t) if stop >= t[-1] else int(np.searchsorted(t, stop, side="left"))
        reached, state = _arc(state, now, stop, t[k:until], thrust, config)
        out[k:until], now, k = reached, stop, until
    return out


def _arcs(start: float, end: float, burns: Sequence[Burn]) -> list[tuple[float, Vector3]]:
    """(end [s], thrust [m/s^2]) of each piece of constant thrust."""
    pieces: list[tuple[float, Vector3]] = []
    at, none = start, np.zeros(3)
    for burn in burns:
        first, last = max(burn.start_s, at), min(burn.end_s, end)
        if last <= first:
            continue
        if first > at:
            pieces.append((first, none))
        pieces.append((last, np.array(burn.acceleration_eci)))
        at = last
    if at < end or not pieces:
        pieces.append((end, none))
    return pieces


def _arc(
    state: Pair, start: float, end: float, t: Float[np.ndarray, "m"], thrust: Vector3, config: ForceConfig
) -> tuple[Float[np.ndarray, "m 12"], Pair]:
    """States at `t` within one arc, and at its end."""
    if end <= start:
        return np.repeat(state[None], len(t), axis=0), state
    B, push = np.array([[TARGET_DRAG], [CHASER_DRAG]]), np.stack([np.zeros(3), thrust])

    def rates(_: float, y: Pair) -> Pair:
        r, v = y.reshape(2, 6)[:, POSITION], y.reshape(2, 6)[:, VELOCITY]
        a = acceleration(r, v, 0.0, config) + B * drag(r, v, 1.0, config) + push
        return np.concatenate([v, a], axis=1).ravel()

    found = scipy.integrate.solve_ivp(
        rates, (start, end), state, method="DOP853", rtol=_RTOL, atol=_ATOL, dense_output=len(t) > 0
    )
    reached = found.sol(np.clip(t, start, end)).T if len(t) else np.empty((0, 12))
    return reached, found.y[:, -1]


def _j2(r: Vector3, radius2: Float[np.ndarray, "*#batch 1"], radius: Float[np.ndarray, "*#batch 1"]) -> Vector3:
    """Montenbruck and Gill, "Satellite Orbits", eq. 3.32 with only C20."""
    k = 1.5 * EARTH_J2 * MU_EARTH * EARTH_EQUATORIAL_RADIUS**2 / (radius2**2 * radius)
    z2 = 5.0 * r[..., 2:] ** 2 / radius2
    return k * r * (z2 - np.array([1.0, 1.0, 3.0]))
