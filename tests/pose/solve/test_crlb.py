"""The Cramer-Rao bound, and the solver against it."""

import numpy as np
import pytest
from scipy.stats import chi2
from tests.pose.solve.cases import CAMERA, FISH, SIX, many, random_pose

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.perturbation import difference
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.crlb import cramer_rao_white
from proxnav.pose.solve.estimate import estimate_pose


def test_solver_reaches_the_bound_at_a_tenth_of_a_pixel(rng: np.random.Generator) -> None:
    points, T, sigma_px, runs = many(12), random_pose(rng, 30.0, 31.0), 0.1, 800
    bound = cramer_rao_white(T, points, FISH, sigma_px)
    covariances = np.tile(sigma_px**2 * np.eye(2), (12, 1, 1))
    config = PoseConfig(loss="squares", inflation="none")
    errors, nees = [], []
    for _ in range(runs):
        pixels = FISH.project(T @ points) + sigma_px * rng.normal(size=(12, 2))
        result = estimate_pose(points, pixels, FISH, covariances, config=config)
        assert result.T_cam_target is not None
        assert result.covariance is not None
        errors.append(difference(result.T_cam_target, T))
        nees.append(errors[-1] @ np.linalg.solve(result.covariance, errors[-1]))
    sample = np.cov(np.array(errors).T)
    whitener = np.linalg.inv(np.linalg.cholesky(bound))
    ratios = np.linalg.eigvalsh(whitener @ sample @ whitener.T)
    assert ratios.min() > 0.8
    assert ratios.max() < 1.25
    assert chi2.ppf(0.001, 6 * runs) < sum(nees) < chi2.ppf(0.999, 6 * runs)


def test_default_solver_is_honest_with_outliers_and_uneven_noise(rng: np.random.Generator) -> None:
    points, nees = many(24), []
    for _ in range(300):
        T = random_pose(rng)
        half = rng.uniform(-1.0, 1.0, (24, 2, 2))
        covariances = half @ half.transpose(0, 2, 1) + 0.05 * np.eye(2)
        noise = np.einsum("nij,nj->ni", np.linalg.cholesky(covariances), rng.normal(size=(24, 2)))
        pixels = CAMERA.project(T @ points) + noise
        pixels[rng.permutation(24)[:3]] = rng.uniform(0.0, 1024.0, (3, 2))
        result = estimate_pose(points, pixels, CAMERA, covariances)
        assert result.T_cam_target is not None
        assert result.covariance is not None
        error = difference(result.T_cam_target, T)
        nees.append(error @ np.linalg.solve(result.covariance, error))
    assert 4.8 < np.mean(nees) < 7.2


def test_bound_has_the_magnitude_of_the_reference_table(rng: np.random.Generator) -> None:
    camera = Camera(1024, 1024, 887.0, 887.0, 512.0, 512.0)
    for range_m, lateral, depth, turn_deg in ((20.0, 0.010, 0.059, 0.38), (50.0, 0.025, 0.366, 0.92)):
        found = []
        for q in quaternion.random(rng, 300):
            T = Pose.from_wxyz("cam", "target", q, [0.0, 0.0, range_m])
            variances = np.diag(cramer_rao_white(T, SIX, camera))
            turn = np.degrees(np.sqrt(variances[3:].sum()))
            found.append([np.sqrt(variances[:2].mean()), np.sqrt(variances[2]), turn])
        ratios = np.median(found, axis=0) / (lateral, depth, turn_deg)
        assert (ratios > 0.6).all()
        assert (ratios < 1.6).all()


def test_bound_scales_with_the_noise(rng: np.random.Generator) -> None:
    T = random_pose(rng)
    np.testing.assert_allclose(cramer_rao_white(T, SIX, CAMERA, 3.0), 9.0 * cramer_rao_white(T, SIX, CAMERA), rtol=1e-9)


def test_two_points_have_no_bound(rng: np.random.Generator) -> None:
    with pytest.raises(InputError, match="do not determine"):
        cramer_rao_white(random_pose(rng), SIX[:2], CAMERA)
