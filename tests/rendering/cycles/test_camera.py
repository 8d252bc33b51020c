"""Blender's camera is ours in other words."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from proxnav.geometry import Camera, Pose, quaternion
from proxnav.rendering.cycles.camera import BlenderView, axes_towards, camera_matrix, from_blender, to_blender

sizes = st.integers(4, 4096)
focals = st.floats(100.0, 30_000.0)
centres = st.floats(-5000.0, 5000.0)


@given(sizes, sizes, focals, st.floats(0.5, 2.0), centres, centres)
def test_there_and_back_is_the_same_camera(width, height, fx, ratio, cx, cy):
    camera = Camera(width, height, fx, fx * ratio, cx, cy)
    back = from_blender(to_blender(camera))
    np.testing.assert_allclose(
        [back.fx, back.fy, back.cx, back.cy], [camera.fx, camera.fy, cx, cy], rtol=1e-9, atol=1e-7
    )


def test_a_centred_camera_by_hand():
    # 36 mm over 1024 px: a pixel is 0.03515625 mm, 1407 px are 49.46484375 mm
    view = to_blender(Camera(1024, 512, 1407.0, 1407.0, 512.0, 256.0))
    assert view == BlenderView(1024, 512, 1.0, 1.0, 36.0, 49.46484375, 0.0, 0.0)


def test_a_principal_point_right_of_the_middle_shifts_the_view_left_and_one_below_shifts_it_up():
    view = to_blender(Camera(1000, 500, 1000.0, 1000.0, 600.0, 270.0))
    assert view.shift_x == pytest.approx(-0.1)
    assert view.shift_y == pytest.approx(0.02)


def test_blender_looks_along_its_negative_z_with_y_up():
    M = camera_matrix(Pose.from_wxyz("cam", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 10.0]))
    np.testing.assert_allclose(M[:3, 3], [0.0, 0.0, -10.0])  # ten metres behind the target along our z
    np.testing.assert_allclose(M[:3, :3] @ [0.0, 0.0, -1.0], [0.0, 0.0, 1.0])
    np.testing.assert_allclose(M[:3, :3] @ [0.0, 1.0, 0.0], [0.0, -1.0, 0.0])


def test_points_before_blenders_camera_are_points_before_ours(rng):
    T = Pose.from_wxyz("cam", "target", quaternion.random(rng, 1)[0], rng.normal(size=3))
    point = rng.normal(size=3)
    local = np.linalg.solve(camera_matrix(T), [*point, 1.0])[:3]
    np.testing.assert_allclose(local * (1.0, -1.0, -1.0), T @ point, atol=1e-12)


@given(st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 1e-3))
def test_the_sun_lamps_axes_are_a_rotation_that_points_to_the_sun(direction):
    R = axes_towards(np.array(direction))
    np.testing.assert_allclose(R @ R.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(R) == pytest.approx(1.0)
    np.testing.assert_allclose(R[:, 2], direction / np.linalg.norm(direction))
