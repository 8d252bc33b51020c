"""The target's orbit as the chaser knows it."""

import numpy as np

from proxnav.flight.truth import Truth
from proxnav.records import EphemerisData

_INTERVAL_S = 30.0
_POSITION_SIGMA_M, _VELOCITY_SIGMA_MPS = 20.0, 0.02
"""Errors per axis, constant over a run: an orbit that its operator has propagated for some hours."""


def read_ephemeris(truth: Truth, rng: np.random.Generator) -> EphemerisData:
    """The target's orbit with a constant error, the last instant included."""
    k = np.unique(np.r_[truth.every(1.0 / _INTERVAL_S), len(truth) - 1])
    r = truth.r_eci_target_m[k] + _POSITION_SIGMA_M * rng.normal(size=3)
    return EphemerisData(truth.t[k], r, truth.v_eci_target_mps[k] + _VELOCITY_SIGMA_MPS * rng.normal(size=3))
