"""A pose refined on an image: pictures of a box painted by OpenCV, side by side, at four times the resolution."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from boxcraft import CORNERS, boxcraft
from painted_box import CAMERA, painted
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.geometry.compiled.lens import lens_numbers
from proxnav.geometry.perturbation import difference, moved
from proxnav.pose.align import AlignConfig, Prior, align
from proxnav.pose.align.config import USUAL_DOUBT
from proxnav.pose.align.kernels.edges import edge_equations
from proxnav.pose.align.outline import outline
from proxnav.pose.align.rivals import rivals
from proxnav.pose.align.score import Sampling, edge_share, region_misfit
from proxnav.pose.align.target_crop import TargetCrop, target_box
from proxnav.pose.align.wireframe import wireframe
from proxnav.records import Keypoints, PoseResult
from proxnav.targets import Target

BENT = Camera(320, 240, 420.0, 420.0, 163.0, 118.0, distortion=(-0.2, 0.1, 0.001, -0.002, 0.0))
FISHEYE = Camera(320, 240, 420.0, 420.0, 163.0, 118.0, (-0.02, 0.006, -0.004, 0.0008), "fisheye")
POSE = Pose("cam", "target", quaternion.exp(np.array([0.5, -0.7, 0.3])), np.array([0.2, -0.1, 9.0]))
FINE = Sampling(blur_px=0.5, spacing_px=2.0)


def prior_of(T: Pose, sigma_m: float = 0.1, sigma_rad: float = 0.05) -> Prior:
    return Prior.of(T, np.diag([sigma_m, sigma_m, 5.0 * sigma_m, sigma_rad, sigma_rad, sigma_rad]) ** 2)


def crop_of(image: np.ndarray, T: Pose, camera: Camera = CAMERA, side: int = 400) -> TargetCrop:
    box = target_box(boxcraft(), T, camera)
    assert box is not None
    return TargetCrop.around(image, box, camera, 1.15, side)


@settings(deadline=None)
@given(arrays(np.float64, 6, elements=st.floats(-1.5, 1.5)))
def test_a_step_and_the_difference_are_inverse(step):
    np.testing.assert_allclose(difference(POSE, moved(POSE, step)), step, atol=1e-9)


def test_a_box_has_twelve_sharp_edges_and_six_flat_ones():
    wire = wireframe(boxcraft())
    lengths = np.linalg.norm(wire.b_m - wire.a_m, axis=1)
    assert len(lengths) == 18
    assert sorted(lengths[wire.sharp].round(9)) == [1.2] * 4 + [2.0] * 4 + [3.0] * 4


@pytest.mark.parametrize("camera", [CAMERA, BENT])
def test_points_of_the_outline_lie_on_edges_of_visible_sides(camera):
    crop = crop_of(painted(POSE, camera), POSE, camera)
    lines = outline(boxcraft(), POSE.R, POSE.t_m, crop, spacing_px=2.0)
    half = np.array([1.5, 1.0, 0.6])
    on = np.isclose(np.abs(lines.points_m), half, atol=1e-9)
    assert len(lines.points_m) > 100
    assert (on.sum(axis=1) >= 2).all()
    eye = -POSE.R.T @ POSE.t_m
    seen = np.sign(eye) * lines.points_m >= half - 1e-9  # a side that looks at the eye has this sign
    assert (seen & (np.abs(eye) > half)).any(axis=1).all()


def test_the_hidden_corner_has_no_outline():
    lines = outline(boxcraft(), POSE.R, POSE.t_m, crop_of(painted(POSE), POSE), spacing_px=1.0)
    eye = -POSE.R.T @ POSE.t_m
    hidden = -np.sign(eye) * [1.5, 1.0, 0.6]
    assert np.linalg.norm(lines.points_m - hidden, axis=1).min() > 0.5  # m


@pytest.mark.parametrize("camera", [CAMERA, BENT, FISHEYE])
@pytest.mark.parametrize("seed", range(4))
def test_a_pose_that_is_off_is_laid_onto_the_image(camera, seed):
    rng = np.random.default_rng(seed)
    off = moved(POSE, np.concatenate([rng.normal(0, [0.06, 0.06, 0.3]), rng.normal(0, 0.03, 3)]))
    found = align(painted(POSE, camera), camera, boxcraft(), prior_of(off))
    assert found is not None
    before, after = np.abs(difference(off, POSE)), np.abs(difference(found.T_cam_target, POSE))
    assert after[:2].max() < 0.01  # m
    assert after[2] < 0.05  # m
    assert after[3:].max() < 0.008  # rad
    assert np.linalg.norm(after) < 0.3 * np.linalg.norm(before)


def dented(share: float) -> Target:
    """The box with its +x +y edge pulled in: with a share near 1 half turns leave it nearly as it was."""
    at_edge = ((CORNERS[:, 0] > 0.0) & (CORNERS[:, 1] > 0.0))[:, None]
    corners = np.where(at_edge, CORNERS * [1.0, share, 1.0], CORNERS)
    return replace(boxcraft(), vertices_m=corners, keypoints_m=corners)


@pytest.mark.parametrize("turned", [False, True])
def test_the_turned_pose_of_a_nearly_symmetric_craft_is_found_out(turned):
    target = dented(0.78)
    mistaken = rivals(target, POSE)
    assert len(mistaken) >= 2
    for start in mistaken if turned else [POSE]:
        found = align(painted(POSE, target=target), CAMERA, target, prior_of(start, 0.05, 0.02))
        assert found is not None
        assert np.abs(difference(found.T_cam_target, POSE))[3:].max() < 0.02  # rad


def test_a_craft_that_half_turns_change_has_no_rivals():
    assert rivals(dented(-0.5), POSE) == []


@pytest.mark.parametrize(("k", "sigma"), [(0, CalibrationSigma(0.02, 0.0)), (1, CalibrationSigma(0.0, 3.0))])
def test_errors_of_the_calibration_move_the_pose_as_its_covariance_says(k, sigma):
    assumed = replace(CAMERA, calibration_sigma=sigma)
    seen = painted(POSE, assumed.erring(-np.eye(3)[k]))  # the assumed camera is larger by one standard deviation
    found = align(seen, assumed, boxcraft(), prior_of(POSE, 0.3, 0.1))
    exact = align(seen, CAMERA, boxcraft(), prior_of(POSE, 0.3, 0.1))
    assert found is not None
    assert exact is not None
    said, moved_by = found.calibration_moves[:, k], difference(POSE, found.T_cam_target)
    axis = (2, 0, 1)[k]  # the focal length is taken for distance, the principal point for a place across
    assert moved_by[axis] == pytest.approx(said[axis], rel=0.2)
    np.testing.assert_allclose(found.covariance - exact.covariance, found.calibration_moves @ found.calibration_moves.T)


def test_the_prior_of_a_result_keeps_what_the_camera_leaves_open_apart():
    noise, moves = np.diag([0.1, 0.1, 0.5, 0.05, 0.05, 0.05]) ** 2, np.zeros((6, 3))
    moves[2, 0] = 0.9
    result = PoseResult("ok", POSE, noise + moves @ moves.T, np.ones(24, bool), 1.0, moves)
    prior = Prior.of_result(result, 0.01)
    np.testing.assert_allclose(prior.covariance, noise, atol=1e-15)
    np.testing.assert_array_equal(prior.calibration_moves, moves)


def test_the_covariance_is_symmetric_positive_and_covers_the_error():
    off = moved(POSE, np.array([0.05, -0.04, 0.2, 0.02, -0.03, 0.02]))
    found = align(painted(POSE), CAMERA, boxcraft(), prior_of(off))
    assert found is not None
    np.testing.assert_allclose(found.covariance, found.covariance.T, atol=1e-12)
    assert np.linalg.eigvalsh(found.covariance).min() > 0
    d = difference(found.T_cam_target, POSE)
    assert d @ np.linalg.solve(found.covariance, d) < 22.5  # 0.1 % of chi-square with 6


def test_doubtful_keypoints_widen_the_outlines_covariance_and_leave_the_pose():
    image, config = painted(POSE), AlignConfig(doubt_power=2.0)
    start = prior_of(POSE)
    usual, doubtful = (
        align(image, CAMERA, boxcraft(), replace(start, doubt=doubt), config) for doubt in (USUAL_DOUBT, 0.0215)
    )
    np.testing.assert_array_equal(doubtful.T_cam_target.t_m, usual.T_cam_target.t_m)
    np.testing.assert_allclose(doubtful.outline_covariance, 16.0 * usual.outline_covariance)
    assert 0.0 < config.widening(0.0) < config.widening(USUAL_DOUBT) == 1.0
    claimed = config.covariance_scale * doubtful.outline_covariance
    assert np.linalg.eigvalsh(doubtful.covariance - claimed).min() > -1e-12  # what rival poses add is left


def test_a_right_pose_explains_the_image_better_than_wrong_ones():
    image, box = painted(POSE), boxcraft()
    crop = crop_of(image, POSE)
    for axis in range(6):
        step = np.zeros(6)
        step[axis] = 0.5 if axis == 2 else 0.12
        wrong = moved(POSE, step)
        assert edge_share(box, POSE, crop, FINE) > edge_share(box, wrong, crop, FINE) + 0.1
        assert region_misfit(box, POSE, crop, 80) < region_misfit(box, wrong, crop, 80) - 0.02


def test_a_picture_painted_side_by_side_is_explained_by_its_sides():
    exact = painted(POSE, noise=0.0)
    assert region_misfit(boxcraft(), POSE, crop_of(exact, POSE), 120) < 0.03  # what is left: pixels across a border


def test_offsets_along_normals_are_those_of_a_step_edge():
    """Image: dark left of x = 50.3 px, bright right of it; the outline runs down x = 49."""
    image = np.full((100, 100), 10.0, np.float32)
    image[:, 51:] = 200.0
    image[:, 50] = 10.0 + 0.7 * 190.0
    gx = cv2.Scharr(image, cv2.CV_32F, 1, 0, scale=1.0 / 32.0)
    gy = cv2.Scharr(image, cv2.CV_32F, 0, 1, scale=1.0 / 32.0)
    lens = lens_numbers(Camera(100, 100, 100.0, 100.0, 50.0, 50.0))
    y = np.linspace(-0.3, 0.3, 20)
    X = np.stack([np.full(20, -0.01), y, np.zeros(20)], axis=1)
    N, R, t = np.tile([1.0, 0.0], (20, 1)), np.eye(3), np.array([0.0, 0.0, 1.0])
    H, g = np.empty((6, 6)), np.empty(6)
    assert edge_equations(X, N, R, t, lens, gx, gy, 6.0, 2.0, 1.0, 1e-6, H, g) == pytest.approx(20, abs=0.01)
    assert g[0] / H[0, 0] * 100.0 == pytest.approx(1.3, abs=0.1)  # px


def test_no_edges_no_share_and_no_target_no_alignment():
    dark = np.full((240, 320), 20, np.uint8)
    assert edge_share(boxcraft(), POSE, crop_of(dark, POSE), FINE) < 0.01
    away = Pose("cam", "target", POSE.q_wxyz, np.array([80.0, 0.0, 9.0]))
    assert align(dark, CAMERA, boxcraft(), prior_of(away)) is None
    behind = Pose("cam", "target", POSE.q_wxyz, np.array([0.0, 0.0, -9.0]))
    assert align(dark, CAMERA, boxcraft(), prior_of(behind)) is None


def test_an_image_without_edges_leaves_the_pose_where_the_keypoints_put_it():
    dark = np.full((240, 320), 20, np.uint8)
    found = align(dark, CAMERA, boxcraft(), prior_of(POSE))
    assert found is not None
    np.testing.assert_allclose(difference(POSE, found.T_cam_target), np.zeros(6), atol=1e-6)


def read_at(T: Pose) -> Keypoints:
    """Keypoints as a network reads them that sees the box at a pose."""
    pixels = CAMERA.project(T @ CORNERS)
    return Keypoints("ok", pixels, np.tile(2.0 * np.eye(2), (8, 1, 1)), np.full(8, 0.99), np.array([0, 0, 1, 1.0]))


@pytest.mark.parametrize("upright_is_right", [True, False])
def test_of_two_readings_of_a_crop_the_one_that_explains_the_image_is_taken(upright_is_right):
    right, wrong = (read_at(moved(POSE, np.array([0, 0, 0, 0, 0, turn]))) for turn in (0.0, 0.6))
    turned, upright = (wrong, right) if upright_is_right else (right, wrong)
    shape = boxcraft()
    estimator = PoseEstimator(
        lambda _: replace(turned, upright=upright), shape.keypoints_m, shape.keypoint_names, shape.name, shape=shape
    )
    found = estimator(painted(POSE), CAMERA).T_cam_target
    assert found is not None
    assert np.abs(difference(found, POSE))[3:].max() < 0.02  # rad
