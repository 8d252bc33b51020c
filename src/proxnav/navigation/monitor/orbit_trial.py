"""The two ephemerides against what the camera sees between the craft: frames of date, clocks."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.celestial import q_eci_mod
from proxnav.navigation.filter_setup import Ephemeris
from proxnav.navigation.kernels.orbit import orbit_at
from proxnav.navigation.monitor.account import AGREES, NOT_COMPARED, Account, unexplained
from proxnav.navigation.monitor.scene import Scene

KIND = "ephemeris against ephemeris"
_HONEST_M = 2e3
"""Farther apart than so is no error of an orbit: elements propagated for a day are within it."""
_EXPLAINED_M = 1e3
_DATE = "(of date)"


class OtherOrbit(NamedTuple):
    """The chaser's own ephemeris, and the epoch of all times."""

    epoch_utc: str
    chaser: Ephemeris


def orbit_account(scene: Scene, other: OtherOrbit | None) -> Account:
    """Whether both craft are where the camera sees them."""
    sights = scene.with_star
    if other is None or sights is None or len(other.chaser.t) < 2:
        return NOT_COMPARED
    t = float(np.clip(sights.t[len(sights.t) // 2], other.chaser.t[0], other.chaser.t[-1]))
    k = int(np.argmin(np.abs(sights.t - t)))
    relative = -quaternion.rotate(sights.q_star[k], sights.position[k])
    target, chaser = _state(scene.setup.ephemeris, t), _state(other.chaser, t)
    rate = scene.setup.orbit(t)[3]
    apart = chaser - target
    if _distance(apart, relative, rate) < _HONEST_M:
        return AGREES
    R = quaternion.to_matrix(q_eci_mod(other.epoch_utc, np.array(t)))
    of_date = {
        f"frames of the two ephemerides differ by precession: ephemeris.csv looks given in TEME {_DATE}, "
        "chaser_ephemeris.csv in J2000": chaser - target @ R.T,
        f"frames of the two ephemerides differ by precession: chaser_ephemeris.csv looks given in TEME {_DATE}, "
        "ephemeris.csv in J2000": chaser @ R.T - target,
    }
    shift = float(apart[0] @ target[1] / (target[1] @ target[1]))
    clock = (
        f"clocks of the two ephemerides differ by {shift:.1f} s, ephemeris.csv is {'behind' if shift > 0 else 'ahead'}"
    )
    causes = of_date | {clock: chaser - _state(scene.setup.ephemeris, t + shift)}
    best = min(causes, key=lambda cause: _distance(causes[cause], relative, rate))
    if _distance(causes[best], relative, rate) < _EXPLAINED_M:
        return Account(1.0, KIND, best)
    size = np.linalg.norm(apart[0] - relative)
    return unexplained(KIND, f"the two ephemerides are {size / 1e3:.1f} km farther apart than the camera sees")


def _state(orbit: Ephemeris, t: float) -> Float[np.ndarray, "2 3"]:
    """Position [m] and velocity [m/s]."""
    r, v, _, _ = orbit_at(*orbit, t)
    return np.array([r, v])


def _distance(apart: Float[np.ndarray, "2 3"], relative: Float[np.ndarray, "3"], rate: float) -> float:
    """Miss of position and velocity together [m]; a velocity counts by how far it leads in a radian of the orbit."""
    return float(np.hypot(np.linalg.norm(apart[0] - relative), np.linalg.norm(apart[1]) / rate))
