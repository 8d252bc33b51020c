"""OpenCV and PoseLib as outside authorities."""

import cv2
import numpy as np
import poselib
import pytest
from tests.pose.solve.cases import CAMERA, SIX, many, random_pose, turn_between

from proxnav.geometry import Pose, quaternion
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.estimate import estimate_pose
from proxnav.pose.solve.kernels.p3p import p3p


def test_three_point_poses_contain_those_of_poselib(rng: np.random.Generator) -> None:
    R, t, missed = np.empty((4, 3, 3)), np.empty((4, 3)), 0
    for _ in range(500):
        X, T = rng.normal(size=(3, 3)) * 2.0, random_pose(rng, 10.0, 100.0)
        rays = T @ X
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        found = p3p(X, rays, 1.0, R, t)
        for other in poselib.p3p(rays, X):
            errors = [np.abs(R[k] - other.R).max() for k in range(found)]
            missed += min(errors, default=9.0) > 1e-5
    assert missed <= 2  # of about 1000: double roots


@pytest.mark.parametrize("points", [SIX, many(24)])
def test_refined_pose_equals_opencvs_least_squares(points: np.ndarray, rng: np.random.Generator) -> None:
    K, _ = CAMERA.to_opencv()
    for _ in range(20):
        T = random_pose(rng, 15.0, 40.0)
        pixels = CAMERA.project(T @ points) + 0.5 * rng.normal(size=(len(points), 2))
        rvec, tvec = cv2.Rodrigues(T.R)[0], T.t_m.reshape(3, 1).copy()
        criteria = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_COUNT, 100, 1e-14)
        rvec, tvec = cv2.solvePnPRefineLM(points, pixels - 0.5, K, np.zeros(5), rvec, tvec, criteria)
        config = PoseConfig(loss="squares", gate_sigma=20.0)
        result = estimate_pose(points, pixels, CAMERA, config=config)
        assert result.T_cam_target is not None
        assert (
            turn_between(result.T_cam_target, Pose.from_matrix("cam", "target", cv2.Rodrigues(rvec)[0], tvec[:, 0]))
            < 1e-4
        )
        assert np.linalg.norm(result.T_cam_target.t_m - tvec[:, 0]) < 1e-2


def test_pose_with_outliers_is_near_poselibs(rng: np.random.Generator) -> None:
    points = many(24)
    camera = {"model": "PINHOLE", "width": 1024, "height": 1024, "params": [1407.0, 1407.0, 512.0, 512.0]}
    for _ in range(20):
        T = random_pose(rng, 15.0, 40.0)
        pixels = CAMERA.project(T @ points) + 0.5 * rng.normal(size=(24, 2))
        pixels[:5] = rng.uniform(0.0, 1024.0, (5, 2))
        pose, _ = poselib.estimate_absolute_pose(pixels, points, camera, {"max_reproj_error": 3.0}, {})
        result = estimate_pose(points, pixels, CAMERA)
        assert result.T_cam_target is not None
        assert quaternion.angle_between(result.T_cam_target.q_wxyz, pose.q) < np.radians(0.5)
        assert np.linalg.norm(result.T_cam_target.t_m - pose.t) < 0.3  # m
