"""Covariances that are as wide as the errors are, whatever the doubt."""

import numpy as np
import pytest

from proxnav.pose.trust.evidence import Doubts
from proxnav.pose.trust.widening import fitted_widening

N = len(Doubts._fields)
USUAL = Doubts(*[0.0] * N)


def drawn(n: int, seed: int, law: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Doubts, and squared errors of six normals whose variance is exp(0.4 + doubts @ law) times the claimed one."""
    rng = np.random.default_rng(seed)
    doubts = rng.normal(size=(n, N))
    return doubts, np.exp(0.4 + doubts @ law) * rng.chisquare(6, n)


def test_the_law_of_the_errors_is_found_and_makes_covariances_honest_at_any_doubt() -> None:
    law = np.array([0.6, 0.0, 0.3, 0.0, 0.0, 0.8, 0.0])
    widening = fitted_widening(*drawn(3000, 1, law), USUAL)
    np.testing.assert_allclose(widening.weights, law, atol=0.1)
    doubts, nees = drawn(3000, 2, law)
    honest = nees / widening.factors(doubts)
    for part in (doubts[:, 5] < -0.5, doubts[:, 5] > 0.5):
        assert honest[part].mean() == pytest.approx(6.0, abs=0.6)


def test_few_poses_move_little_and_a_confusion_widens_nothing() -> None:
    doubts, nees = drawn(60, 3, np.zeros(N))
    widening = fitted_widening(doubts, nees, USUAL)
    assert np.abs(widening.weights).max() < 0.3
    nees[7] = 1e7
    again = fitted_widening(doubts, nees, USUAL)
    assert again.constant == pytest.approx(widening.constant, abs=0.3)


def test_doubt_never_narrows() -> None:
    doubts, nees = drawn(500, 4, np.array([-0.8, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    assert min(fitted_widening(doubts, nees, USUAL).weights) >= 0.0
