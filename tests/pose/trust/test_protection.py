"""Errors stay below their protection levels as often as is claimed, also where doubt is largest."""

import numpy as np
import pytest

from proxnav.pose.trust.protection import ProtectionFactors, calibrated_protection


def drawn(n: int, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Errors with a heavy tail that grows with doubt, the covariances that are claimed, and the doubt."""
    rng = np.random.default_rng(seed)
    doubt = rng.random(n) ** 3
    sigma = rng.uniform(0.01, 1.0, (n, 6))
    errors = sigma * rng.standard_t(5.0, (n, 6)) * (1.0 + 4.0 * doubt)[:, None]
    return errors, np.einsum("ni,ij->nij", sigma**2, np.eye(6)), doubt


def exceeded(factors: ProtectionFactors, errors: np.ndarray, covariances: np.ndarray, doubt: np.ndarray) -> np.ndarray:
    levels = np.array([factors.levels(c, float(p)) for c, p in zip(covariances, doubt, strict=True)])
    return (np.abs(errors) > levels).any(axis=1)


def test_enough_frames_carry_the_risk_overall_and_in_the_hardest_quarter() -> None:
    factors = calibrated_protection(*drawn(20_000, 1), risk=0.01)
    errors, covariances, doubt = drawn(20_000, 2)
    over = exceeded(factors, errors, covariances, doubt)
    assert over.mean() < 3 * 0.013  # three kinds of axes share the risk of one
    assert over[doubt > np.quantile(doubt, 0.75)].mean() < 3 * 0.02


def test_few_frames_extrapolate_their_tail_and_stay_above_what_was_seen() -> None:
    errors, covariances, doubt = drawn(120, 3)
    factors = calibrated_protection(errors, covariances, doubt, risk=1e-3)
    assert not exceeded(factors, errors, covariances, doubt).any()
    assert exceeded(factors, *drawn(4000, 4)).mean() < 0.06  # a tail of Student is heavier than an exponential one


def test_more_doubt_never_protects_less() -> None:
    factors = calibrated_protection(*drawn(2000, 5), risk=1e-3)
    assert len(factors.factors) == len(factors.edges) + 1 == 4
    assert (np.diff(np.array(factors.factors), axis=0) >= 0.0).all()


@pytest.mark.parametrize(("hazard", "own"), [(0.0, 2.0), (0.1, 5.0), (0.9, 5.0)])
def test_levels_are_factors_on_the_claimed_deviations(hazard: float, own: float) -> None:
    factors = ProtectionFactors(1e-3, (0.1,), ((2.0, 3.0, 4.0), (5.0, 6.0, 7.0)))
    levels = factors.levels(np.diag([4.0, 4.0, 9.0, 0.01, 0.01, 0.01]), hazard)
    np.testing.assert_allclose(levels, [2 * own, 2 * own, 3 * (own + 1), *[0.1 * (own + 2)] * 3])
