"""Relative motion against brahe, an independent astrodynamics library (MIT)."""

import numpy as np
import pytest

from navigation.orbits import ELLIPSE_STATE, TWO_BODY, target_at
from proxnav.flight.orbit_forces import fly
from proxnav.geometry.relative_motion import eci_from_ric
from proxnav.navigation.relative_elements import elements, relative_elements

brahe = pytest.importorskip("brahe", reason="brahe is not installed (extra dev)")


@pytest.mark.parametrize("seed", range(3))
def test_relative_elements_are_those_of_brahe(seed: int) -> None:
    rng = np.random.default_rng(seed)
    target = target_at(float(rng.uniform(0, 0.02)), float(rng.uniform(-3, 3)))
    chaser = eci_from_ric(*target, rng.normal(size=3) * 50.0, rng.normal(size=3) * 0.05)
    mine = relative_elements(elements(*target), elements(*chaser)).vector
    theirs = brahe.state_eci_to_roe(np.concatenate(target), np.concatenate(chaser), brahe.AngleFormat.RADIANS)
    theirs[[1, 4, 5]] = (theirs[[1, 4, 5]] + np.pi) % (2.0 * np.pi) - np.pi  # brahe counts angles from 0 to 2 pi
    np.testing.assert_allclose(mine, theirs, atol=1e-9)  # rad: brahe's mu differs in the tenth digit


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
