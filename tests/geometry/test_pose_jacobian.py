"""How pixels move with the pose."""

import numpy as np
import pytest
from tests.pose.solve.cases import CAMERA, FISH, SIX, random_pose

from proxnav.geometry import Camera
from proxnav.geometry.perturbation import moved
from proxnav.geometry.pose_jacobian import pose_jacobian, pose_jacobians_target_axes


@pytest.mark.parametrize("camera", [CAMERA, FISH])
def test_jacobian_agrees_with_finite_differences(camera: Camera, rng: np.random.Generator) -> None:
    T, step = random_pose(rng, 15.0, 40.0), 1e-6
    J = pose_jacobian(T, SIX, camera)
    for k in range(6):
        delta = step * np.eye(6)[k]
        numeric = (camera.project(moved(T, delta) @ SIX) - camera.project(moved(T, -delta) @ SIX)) / (2 * step)
        np.testing.assert_allclose(J[..., k], numeric, rtol=1e-6, atol=1e-4)  # px/m, px/rad


@pytest.mark.parametrize("camera", [CAMERA, FISH])
def test_a_turn_in_target_axes_moves_the_pixels_as_the_same_turn_in_camera_axes(
    camera: Camera, rng: np.random.Generator
) -> None:
    poses = [random_pose(rng, 15.0, 40.0) for _ in range(3)]
    q, t_m = np.array([T.q_wxyz for T in poses]), np.array([T.t_m for T in poses])
    for T, J in zip(poses, pose_jacobians_target_axes(q, t_m, SIX, camera), strict=True):
        J_cam = pose_jacobian(T, SIX, camera)
        np.testing.assert_allclose(J[..., :3], J_cam[..., :3], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(J[..., 3:], J_cam[..., 3:] @ T.R, rtol=1e-9, atol=1e-9)
