"""The compiled geometry agrees with the one on arrays: lens, rotations and small steps between poses."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from proxnav.geometry import Camera, Pose, distortion, perturbation, quaternion, so3
from proxnav.geometry.compiled import lens, rotations, vectors
from proxnav.geometry.compiled import perturbation as compiled

POSE = Pose("cam", "target", quaternion.exp(np.array([0.5, -0.7, 0.3])), np.array([0.2, -0.1, 9.0]))
BENT = Camera(200, 160, 300.0, 310.0, 97.0, 83.0, (-0.22, 0.31, -0.0007, 0.0004, -0.1))
STRAIGHT = Camera(200, 160, 300.0, 310.0, 97.0, 83.0)
steps = arrays(np.float64, 6, elements=st.floats(-1.5, 1.5))


@settings(deadline=None)
@given(steps)
def test_steps_between_poses_are_those_of_geometry(step: np.ndarray) -> None:
    there, R, t, back = perturbation.moved(POSE, step), np.empty((3, 3)), np.empty(3), np.empty(6)
    compiled.moved(POSE.R, POSE.t_m, step, R, t)
    compiled.difference(POSE.R, POSE.t_m, R, t, back)
    np.testing.assert_allclose(R, there.R, atol=1e-12)
    np.testing.assert_allclose(t, there.t_m, atol=1e-12)
    np.testing.assert_allclose(back, step, atol=1e-7)


@settings(deadline=None)
@given(arrays(np.float64, 3, elements=st.floats(-1.5, 1.5)))
def test_rotations_are_those_of_geometry(phi: np.ndarray) -> None:
    R, q = so3.exp(phi), rotations.exp(phi)
    np.testing.assert_allclose(rotations.to_matrix(q), R, atol=1e-12)
    np.testing.assert_allclose(quaternion.canonical(rotations.from_matrix(R)), quaternion.canonical(q), atol=1e-12)
    np.testing.assert_allclose(rotations.log_matrix(R), phi, atol=1e-7)
    np.testing.assert_allclose(vectors.rotate(R, phi), R @ phi, atol=1e-12)
    np.testing.assert_allclose(vectors.cross(phi, R[0]), np.cross(phi, R[0]), atol=1e-12)


@pytest.mark.parametrize("camera", [STRAIGHT, BENT], ids=["straight", "distorted"])
def test_pixels_are_those_of_the_camera(camera: Camera, rng: np.random.Generator) -> None:
    row = lens.lens_numbers(camera)
    for point in rng.uniform((-0.3, -0.3, 1.0), (0.3, 0.3, 3.0), (50, 3)):
        pixel = camera.project(point)
        np.testing.assert_allclose(lens.project(np.eye(3), np.zeros(3), point, row, 1e-3), pixel, atol=1e-10)
        xy, xd = np.empty((1, 2)), distortion.distort(point[:2] / point[2], camera.distortion)
        lens.undistort_pixels(pixel[None], row, xy)
        np.testing.assert_allclose(xy[0], point[:2] / point[2], atol=1e-9)
        np.testing.assert_allclose(lens.undistort(*xd, row), point[:2] / point[2], atol=1e-11)
