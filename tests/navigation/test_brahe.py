"""Relative motion against brahe, an independent astrodynamics library (MIT)."""

import numpy as np
import pytest

from navigation.orbits import ELLIPSE_STATE, TWO_BODY, target_at
from proxnav.flight.orbit_forces import fly
from proxnav.geometry.relative_motion import eci_from_ric

brahe = pytest.importorskip("brahe", reason="brahe is not installed (extra dev)")


def test_relative_states_are_those_of_brahe() -> None:
    target = target_at(0.01, 0.7)
    chaser = eci_from_ric(*target, *ELLIPSE_STATE)
    theirs = brahe.state_eci_to_rtn(np.concatenate(target), np.concatenate(chaser))
    np.testing.assert_allclose(np.concatenate(ELLIPSE_STATE), theirs, atol=1e-6)  # m, m/s


def test_two_body_motion_is_that_of_braes_keplerian_elements() -> None:
    r, v = target_at(0.1, 0.5)
    koe = brahe.state_eci_to_koe(np.concatenate([r, v]), brahe.AngleFormat.RADIANS)
    koe[5] += np.sqrt(brahe.GM_EARTH / koe[0] ** 3) * 4000.0
    theirs = brahe.state_koe_to_eci(koe, brahe.AngleFormat.RADIANS)
    mine = fly(np.concatenate([r, v, r, v]), np.array([0.0, 4000.0]), TWO_BODY)[-1, :6]
    np.testing.assert_allclose(mine, theirs, atol=0.05)  # m: the constants differ
