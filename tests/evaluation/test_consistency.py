"""Honesty of covariances and distance to the bound."""

import numpy as np
import pytest
from scipy.stats import chi2
from tests.evaluation.records import disturbed, truth_along

from proxnav.evaluation.consistency import consistency, efficiency_by_range
from proxnav.evaluation.error_tables import consistency_line
from proxnav.evaluation.pairing import pair
from proxnav.geometry import Pose, so3
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference


def correlated(rng: np.random.Generator) -> np.ndarray:
    half = rng.normal(size=(6, 6)) * 0.02
    return half @ half.T + 1e-5 * np.eye(6)


def test_honest_covariances_are_found_consistent(rng: np.random.Generator) -> None:
    truth, covariance = truth_along(rng, rng.uniform(10.0, 100.0, 2000)), correlated(rng)
    found = consistency(pair(disturbed(truth, covariance, rng), truth))
    assert found is not None
    low, high = chi2.ppf([0.0005, 0.9995], 6 * 2000) / 2000
    assert low < found.mean_nees < high
    assert found.beyond_3_sigma < 0.01
    assert found.axis_beyond_3_sigma < 0.01


@pytest.mark.parametrize("claimed", [0.25, 4.0])
def test_covariances_off_by_two_sigma_are_found_out(claimed: float, rng: np.random.Generator) -> None:
    truth = truth_along(rng, rng.uniform(10.0, 100.0, 300))
    found = consistency(pair(disturbed(truth, correlated(rng), rng, claimed), truth))
    assert found is not None
    assert not found.is_consistent
    assert found.mean_nees == pytest.approx(6.0 / claimed, rel=0.2)


def test_difference_is_what_the_covariance_is_of(rng: np.random.Generator) -> None:
    dt, dr = np.array([0.1, -0.2, 0.3]), np.array([0.02, 0.01, -0.03])
    T_est = Pose.from_wxyz("cam", "target", [0.5, 0.5, 0.5, 0.5], [1.0, 2.0, 30.0])
    T_true = Pose.from_matrix("cam", "target", so3.exp(dr) @ T_est.R, T_est.t_m + dt)
    np.testing.assert_allclose(difference(T_est, T_true), [*dt, *dr], atol=1e-12)


def test_nees_by_hand_and_of_a_singular_claim() -> None:
    covariance = np.diag([4.0, 1.0, 1.0, 0.25, 1.0, 1.0])
    assert squared_mahalanobis(np.array([2.0, 0.0, 3.0, 1.0, 0.0, 0.0]), covariance) == pytest.approx(1.0 + 9.0 + 4.0)
    assert squared_mahalanobis(np.ones(6), np.zeros((6, 6))) == np.inf
    stack = squared_mahalanobis(np.ones((2, 6)), np.stack([np.zeros((6, 6)), covariance]))
    np.testing.assert_allclose(stack, [np.inf, 0.25 + 1.0 + 1.0 + 4.0 + 1.0 + 1.0])


def test_estimates_without_covariance_claim_nothing(rng: np.random.Generator) -> None:
    truth = truth_along(rng, np.array([10.0, 20.0]))
    assert consistency(pair(truth, truth)) is None
    assert "claim none" in consistency_line(None)


def test_efficiency_is_one_at_the_bound_and_two_at_twice_the_error(rng: np.random.Generator) -> None:
    truth, covariance = truth_along(rng, rng.uniform(10.0, 100.0, 800)), correlated(rng)
    bounds = dict.fromkeys(truth, covariance)
    for factor in (1.0, 2.0):
        frames = pair(disturbed(truth, factor**2 * covariance, rng), truth)
        for found in efficiency_by_range(frames, bounds, (0.0, 50.0, 150.0)).values():
            assert found.translation == pytest.approx(factor, rel=0.15)
            assert found.rotation == pytest.approx(factor, rel=0.15)
            assert 0.5 * factor < found.median_t < factor
            assert 0.5 * factor < found.median_r < factor
