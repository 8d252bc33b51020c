"""Poses checked by the view that they predict."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.datasets.skies import sky_of
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Pose, quaternion
from proxnav.geometry.perturbation import moved
from proxnav.geometry.pose_errors import pose_errors
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.pose.trust import Evidence
from proxnav.records import PoseResult, SceneSpec
from proxnav.targets.loading import load_target
from proxnav.verification import verifier_of


@pytest.fixture(scope="module")
def frame() -> tuple[np.ndarray, SceneSpec]:
    scene = draw_scenes(load_mission("observation-10-100m"), 1, seed=12)[0]
    image = FrameJob("space-rider", FrameConfig("raycast"))()(scene).image
    return image, scene


def half_turned(T: Pose) -> Pose:
    turn = quaternion.exp(np.array([0.0, 0.0, np.pi]))
    return Pose.from_wxyz("cam", "target", quaternion.multiply(T.q_wxyz, turn), T.t_m)


@pytest.mark.slow
def test_the_true_pose_is_like_the_picture_and_its_half_turn_is_not(frame) -> None:
    image, scene = frame
    verifier = verifier_of(load_target("space-rider"))
    true = verifier.similarity(image, scene.camera, scene.T_cam_target, sky_of(scene))
    wrong = verifier.similarity(image, scene.camera, half_turned(scene.T_cam_target), sky_of(scene))
    assert true.score > 0.647 > wrong.score + 0.2


@pytest.mark.slow
def test_the_estimator_refuses_what_the_picture_contradicts_and_says_why(frame) -> None:
    image, scene = frame
    estimator = PoseEstimator.load("space-rider", threads=1)
    known = sky_of(scene)
    result = estimator(image, scene.camera, sun_cam=known.sun_cam, nadir_cam=known.nadir_cam)
    assert (result.status, result.trust.verdict) == ("ok", "verified")
    assert result.trust.hazard < 0.05
    assert np.isfinite([*result.trust.protection_m, *result.trust.protection_rad]).all()
    wrong = PoseResult("ok", half_turned(scene.T_cam_target), np.eye(6), np.ones(24, bool))
    view = verifier_of(estimator.shape).similarity(image, scene.camera, wrong.T_cam_target, known)
    refused = estimator.judged(wrong, Evidence(0.99, 0.7, 0.01, 0.002, 0.5, view))
    assert (refused.status, refused.T_cam_target, refused.trust.verdict) == ("unlike_render", None, "contradicted")
    assert estimator(image, scene.camera).trust.verdict == "not_verifiable"
    assert replace(estimator, checked_by="nothing")(image, scene.camera).trust is None


@pytest.mark.slow
def test_a_pose_is_moved_to_the_picture_and_its_covariance_keeps_what_the_camera_does_not_know(frame) -> None:
    image, scene = frame
    estimator = PoseEstimator.load("space-rider", threads=1)
    start = moved(scene.T_cam_target, np.array([0.01, -0.01, 0.1, 0.008, -0.006, 0.004]))
    covariance = np.diag([0.05, 0.05, 0.4, 0.03, 0.03, 0.03]) ** 2
    moves = np.zeros((6, 3))
    moves[2, 0] = 0.3
    before = PoseResult("ok", start, covariance + moves @ moves.T, np.ones(24, bool), calibration_moves=moves)
    evidence = Evidence(0.99, 0.7, 0.01, 0.002, 0.5)
    after, seen = estimator.compared(image, scene.camera, before, evidence, sky_of(scene))
    off = [pose_errors(one.T_cam_target, scene.T_cam_target).e_r_rad for one in (before, after)]
    assert off[1] < 0.85 * off[0]
    assert seen.view.score > 0.647
    assert after.covariance[2, 2] > 0.3**2
    assert np.trace(after.covariance) < np.trace(before.covariance)
