"""Pose from keypoints: exactness, outliers, degenerate input, symmetry of the problem."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.pose.solve.cases import BUBBLE, CAMERA, FISH, PRISM, SIX, many, random_pose, turn_between

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.geometry.perturbation import difference
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.estimate import estimate_pose


def assert_same_pose(T: Pose | None, T_true: Pose, metres: float = 1e-6, rad: float = 1e-6) -> None:
    assert T is not None
    assert np.linalg.norm(T.t_m - T_true.t_m) < metres
    assert turn_between(T, T_true) < rad


@pytest.mark.parametrize("camera", [CAMERA, FISH, PRISM, BUBBLE])
@pytest.mark.parametrize("points", [SIX, many(24), many(200)])
@given(seed=st.integers(0, 10_000))
@settings(max_examples=25, deadline=None)
def test_noiseless_points_give_the_pose_to_a_micrometre(seed: int, points: np.ndarray, camera: Camera) -> None:
    T = random_pose(np.random.default_rng(seed))
    result = estimate_pose(points, camera.project(T @ points), camera)
    assert result.status == "ok"
    assert_same_pose(result.T_cam_target, T)
    assert result.inliers.all()
    assert result.reprojection_rms_px < 1e-6


def _determined_by_four(points: np.ndarray, pixels: np.ndarray) -> bool:
    """Whether the second best pose of four exact points misses them by more than 3 px in total."""
    result = estimate_pose(points, pixels, CAMERA, np.tile(np.eye(2), (4, 1, 1)))
    return result.status == "ok"


def test_two_of_six_points_wrong_by_100_px_are_found(rng: np.random.Generator) -> None:
    determined, recovered = 0, 0
    for _ in range(400):
        T = random_pose(rng)
        pixels = CAMERA.project(T @ SIX)
        wrong = rng.permutation(6)[:2]
        angle = rng.uniform(0.0, 2.0 * np.pi, 2)
        good = np.setdiff1d(np.arange(6), wrong)
        if not _determined_by_four(SIX[good], pixels[good]):
            continue
        pixels[wrong] += 100.0 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        determined += 1
        result = estimate_pose(SIX, pixels, CAMERA)
        right = result.T_cam_target is not None and turn_between(result.T_cam_target, T) < 1e-4
        recovered += right and not result.inliers[wrong].any()
    assert determined > 200
    assert recovered >= 0.99 * determined


def test_a_fifth_of_24_noisy_points_wrong_never_breaks_the_pose(rng: np.random.Generator) -> None:
    points = many(24)
    for _ in range(100):
        T = random_pose(rng)
        pixels = CAMERA.project(T @ points) + rng.normal(size=(24, 2))
        wrong = rng.permutation(24)[:5]
        pixels[wrong] = rng.uniform(0.0, 1024.0, (5, 2))
        result = estimate_pose(points, pixels, CAMERA)
        assert result.status == "ok"
        assert result.T_cam_target is not None
        assert turn_between(result.T_cam_target, T) < np.radians(8.0)
        assert result.inliers.sum() >= 16


@pytest.mark.parametrize("thickness_m", [0.0, 1e-6, 1e-3])
def test_planar_and_nearly_planar_points_are_exact(rng: np.random.Generator, thickness_m: float) -> None:
    points = rng.uniform(-3.0, 3.0, (8, 3)) * [1.0, 1.0, thickness_m / 3.0]
    for _ in range(50):
        T = random_pose(rng)
        result = estimate_pose(points, CAMERA.project(T @ points), CAMERA)
        assert result.status == "ok"
        assert_same_pose(result.T_cam_target, T, 1e-5, 1e-5)


def test_four_exact_points_are_enough(rng: np.random.Generator) -> None:
    solved = 0
    for _ in range(100):
        T = random_pose(rng, 8.0, 40.0)
        result = estimate_pose(SIX[:4], CAMERA.project(T @ SIX[:4]), CAMERA)
        if result.status == "ok":
            assert_same_pose(result.T_cam_target, T, 1e-5, 1e-5)
            solved += 1
    assert solved >= 97


def test_a_far_square_seen_with_noise_is_refused_as_ambiguous() -> None:
    square = np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]])
    tilt = quaternion.exp(np.array([0.5, 0.0, 0.0]))
    T = Pose.from_wxyz("cam", "target", tilt, [0.0, 0.0, 100.0])
    result = estimate_pose(square, CAMERA.project(T @ square), CAMERA, np.tile(np.eye(2), (4, 1, 1)))
    assert result.status == "no_consensus"


@pytest.mark.parametrize("n", [0, 1, 2, 3])
def test_fewer_than_four_points_are_too_few(n: int) -> None:
    result = estimate_pose(SIX[:n], np.full((n, 2), 512.0), CAMERA)
    assert result.status == "too_few_points"
    assert result.T_cam_target is None
    assert result.covariance is None
    assert result.inliers.shape == (n,)


def test_nan_infinite_and_unscored_points_are_left_out(rng: np.random.Generator) -> None:
    points, T = many(12), random_pose(rng)
    pixels, scores = CAMERA.project(T @ points), np.ones(12)
    pixels[0], pixels[1, 1], pixels[2, 0] = np.nan, np.nan, np.inf
    scores[3], pixels[3] = 0.0, (0.0, 0.0)
    scores[4] = np.nan
    covariances = np.tile(np.eye(2), (12, 1, 1))
    covariances[5] = np.nan
    covariances[6] = -np.eye(2)
    result = estimate_pose(points, pixels, CAMERA, covariances, scores)
    assert result.inliers.tolist() == [False] * 7 + [True] * 5
    assert_same_pose(result.T_cam_target, T)
    assert estimate_pose(points, np.full((12, 2), np.nan), CAMERA).status == "too_few_points"


def test_repeated_points_count_once(rng: np.random.Generator) -> None:
    T = random_pose(rng)
    three_twice = np.concatenate([SIX[:3], SIX[:3]])
    assert estimate_pose(three_twice, CAMERA.project(T @ three_twice), CAMERA).status == "too_few_points"
    noisy_repeat = CAMERA.project(T @ three_twice) + rng.normal(size=(6, 2))
    assert estimate_pose(three_twice, noisy_repeat, CAMERA).status == "too_few_points"
    twice = np.concatenate([SIX, SIX])
    pixels = CAMERA.project(T @ SIX) + rng.normal(size=(6, 2)) * 0.3
    once = estimate_pose(SIX, pixels, CAMERA)
    result = estimate_pose(twice, np.concatenate([pixels, pixels]), CAMERA)
    assert once.T_cam_target is not None
    assert_same_pose(result.T_cam_target, once.T_cam_target)
    assert result.covariance is not None
    np.testing.assert_allclose(result.covariance, once.covariance, rtol=1e-9)


def test_points_on_a_line_give_no_pose(rng: np.random.Generator) -> None:
    line = np.outer(np.linspace(-3.0, 3.0, 8), [0.3, 0.8, 0.5])
    T = random_pose(rng)
    assert estimate_pose(line, CAMERA.project(T @ line), CAMERA).status == "no_consensus"


def test_points_behind_the_camera_are_named_so(rng: np.random.Generator) -> None:
    points = many(10)
    T = random_pose(rng)
    behind = Pose.from_wxyz("cam", "target", T.q_wxyz, T.t_m * [1.0, 1.0, -1.0])
    p = behind @ points
    pixels = p[:, :2] / p[:, 2:] * 1407.0 + 512.0
    assert estimate_pose(points, pixels, CAMERA).status == "behind_camera"


def test_random_pixels_give_no_pose(rng: np.random.Generator) -> None:
    points = many(24)
    statuses = [estimate_pose(points, rng.uniform(0.0, 1024.0, (24, 2)), CAMERA).status for _ in range(30)]
    assert statuses.count("ok") == 0


def test_the_pose_moves_with_the_targets_frame(rng: np.random.Generator) -> None:
    T_target_panel = Pose.from_wxyz("target", "panel", quaternion.random(rng, 1)[0], [30.0, -20.0, 5.0])
    points, T = many(12), random_pose(rng)
    pixels = CAMERA.project(T @ points) + rng.normal(size=(12, 2))
    a = estimate_pose(points, pixels, CAMERA)
    b = estimate_pose(T_target_panel.inverse() @ points, pixels, CAMERA)
    assert a.T_cam_target is not None
    moved = a.T_cam_target @ T_target_panel
    assert b.T_cam_target is not None
    assert np.linalg.norm(b.T_cam_target.t_m - moved.t_m) < 1e-5  # m
    assert quaternion.angle_between(b.T_cam_target.q_wxyz, moved.q_wxyz) < 1e-6  # rad


def test_the_order_of_points_does_not_matter_beyond_the_draw(rng: np.random.Generator) -> None:
    points, T = many(9), random_pose(rng)
    pixels = CAMERA.project(T @ points) + rng.normal(size=(9, 2))
    pixels[4] += 80.0
    order = rng.permutation(9)
    a, b = estimate_pose(points, pixels, CAMERA), estimate_pose(points[order], pixels[order], CAMERA)
    assert b.T_cam_target is not None
    assert_same_pose(a.T_cam_target, b.T_cam_target, 1e-4, 1e-5)
    assert a.inliers[order].tolist() == b.inliers.tolist()


def test_the_same_input_gives_the_same_bits(rng: np.random.Generator) -> None:
    points, T = many(24), random_pose(rng)
    pixels = CAMERA.project(T @ points) + rng.normal(size=(24, 2))
    a, b = (estimate_pose(points, pixels, CAMERA) for _ in range(2))
    assert a.T_cam_target is not None
    assert b.T_cam_target is not None
    assert a.T_cam_target.matrix().tobytes() == b.T_cam_target.matrix().tobytes()


def test_a_doubtful_point_weighs_less(rng: np.random.Generator) -> None:
    points, T = many(10), random_pose(rng, 20.0, 30.0)
    covariances = np.tile(0.01 * np.eye(2), (10, 1, 1))
    covariances[0] = 100.0 * np.eye(2)
    pixels = CAMERA.project(T @ points)
    pixels[0] += 8.0
    result = estimate_pose(points, pixels, CAMERA, covariances)
    assert result.inliers.all()
    assert_same_pose(result.T_cam_target, T, 0.02, 1e-3)


def test_noise_above_the_assumed_is_noticed_and_claimed(rng: np.random.Generator) -> None:
    points, T = many(24), random_pose(rng, 20.0, 25.0)
    quiet = estimate_pose(points, CAMERA.project(T @ points), CAMERA)
    loud = estimate_pose(points, CAMERA.project(T @ points) + 4.0 * rng.normal(size=(24, 2)), CAMERA)
    assert loud.status == "ok"
    assert loud.covariance is not None
    assert quiet.covariance is not None
    ratio = np.sqrt(np.trace(loud.covariance) / np.trace(quiet.covariance))
    assert 2.5 < ratio < 6.0
    assert loud.inliers.sum() >= 22


def test_wrong_shapes_are_named() -> None:
    with pytest.raises(InputError, match="6 points of the target but 5 pixels"):
        estimate_pose(SIX, np.zeros((5, 2)), CAMERA)
    with pytest.raises(InputError, match=r"points_target_m needs shape \(n, 3\)"):
        estimate_pose(SIX.T, np.zeros((3, 2)), CAMERA)
    with pytest.raises(InputError, match="covariances_px2"):
        estimate_pose(SIX, np.zeros((6, 2)), CAMERA, np.ones((6, 2)))
    with pytest.raises(InputError, match="scores"):
        estimate_pose(SIX, np.zeros((6, 2)), CAMERA, scores=np.ones(5))


def test_arguments_are_left_as_they_were(rng: np.random.Generator) -> None:
    points, T = many(12), random_pose(rng)
    pixels, covariances = CAMERA.project(T @ points), np.tile(np.eye(2), (12, 1, 1))
    before = [a.copy() for a in (points, pixels, covariances)]
    estimate_pose(points, pixels, CAMERA, covariances, config=PoseConfig(loss="cauchy"))
    for array, copy in zip((points, pixels, covariances), before, strict=True):
        np.testing.assert_array_equal(array, copy)


def test_lists_are_welcome() -> None:
    T = Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 20.0])
    result = estimate_pose(SIX.tolist(), CAMERA.project(T @ SIX).tolist(), CAMERA)
    assert_same_pose(result.T_cam_target, T)


def test_solving_needs_no_torch() -> None:
    heavy = ("torch", "cv2", "ray", "bpy")
    code = f"import sys, proxnav.pose.solve.estimate; sys.exit(any(m in sys.modules for m in {heavy}))"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


@pytest.mark.parametrize(
    "wrong",
    [{"sigma_px": 0.0}, {"min_inliers": 3}, {"min_inlier_share": 1.5}, {"gate_sigma": -1.0}],
)
def test_configurations_without_meaning_are_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(InputError, match=next(iter(wrong))):
        PoseConfig(**wrong)  # pyright: ignore


def test_covariances_stay_honest_when_the_camera_errs_by_what_is_declared() -> None:
    """Mean squared error in units of the claimed covariance, 6 for honest ones; hundreds with nothing declared."""
    camera = replace(CAMERA, calibration_sigma=CalibrationSigma(0.01, 5.0))
    rng, told, silent = np.random.default_rng(5), [], []
    noise = np.tile(np.eye(2), (len(many(24)), 1, 1))
    for _ in range(120):
        T = random_pose(rng, far_m=60.0)
        pixels = camera.erring(rng.normal(size=3)).project(T @ many(24)) + rng.normal(size=(len(many(24)), 2))
        for found, assumed in ((told, camera), (silent, CAMERA)):
            result = estimate_pose(many(24), pixels, assumed, noise)
            assert result.T_cam_target is not None
            e = difference(result.T_cam_target, T)
            found.append(e @ np.linalg.solve(result.covariance, e))
    assert 4.8 < np.mean(told) < 7.2
    assert np.mean(silent) > 50.0


def test_poses_move_with_the_camera_as_the_linearisation_says() -> None:
    camera = replace(CAMERA, calibration_sigma=CalibrationSigma(1e-4, 0.05))
    T = Pose("cam", "target", quaternion.exp(np.array([0.4, -0.3, 0.8])), np.array([0.5, -0.3, 20.0]))
    noise = np.tile(np.eye(2), (len(many(24)), 1, 1))
    exact = estimate_pose(many(24), camera.project(T @ many(24)), camera, noise)
    for k, errors in enumerate(np.eye(3)):
        seen = camera.erring(-errors).project(T @ many(24))  # the assumed camera is larger by one standard deviation
        moved = difference(T, estimate_pose(many(24), seen, CAMERA, noise).T_cam_target)
        assert moved == pytest.approx(exact.calibration_moves[:, k], rel=0.02, abs=1e-6)
