"""Both orbits as the chaser knows them."""

import numpy as np
from jaxtyping import Int

from proxnav.flight.truth import Truth
from proxnav.records import EphemerisData

_INTERVAL_S = 30.0
_POSITION_SIGMA_M, _VELOCITY_SIGMA_MPS = 20.0, 0.02
"""Errors per axis, constant over a run: an orbit that its operator has propagated for some hours."""
_OWN_POSITION_SIGMA_M, _OWN_VELOCITY_SIGMA_MPS = 5.0, 0.02
"""The same of the chaser's own receiver."""


def read_ephemeris(truth: Truth, rng: np.random.Generator) -> EphemerisData:
    """The target's orbit with a constant error, the last instant included."""
    k = _instants(truth)
    r = truth.r_eci_target_m[k] + _POSITION_SIGMA_M * rng.normal(size=3)
    return EphemerisData(truth.t[k], r, truth.v_eci_target_mps[k] + _VELOCITY_SIGMA_MPS * rng.normal(size=3))


def read_chaser_ephemeris(truth: Truth, rng: np.random.Generator) -> EphemerisData:
    """The chaser's orbit by its own GNSS receiver, with a constant error."""
    k = _instants(truth)
    r = truth.r_eci_chaser_m[k] + _OWN_POSITION_SIGMA_M * rng.normal(size=3)
    return EphemerisData(truth.t[k], r, truth.v_eci_chaser_mps[k] + _OWN_VELOCITY_SIGMA_MPS * rng.normal(size=3))


def _instants(truth: Truth) -> Int[np.ndarray, "n"]:
    return np.unique(np.r_[truth.every(1.0 / _INTERVAL_S), len(truth) - 1])
