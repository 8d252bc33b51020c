"""Attitudes from directions."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from proxnav.geometry import quaternion
from proxnav.geometry.arrays import unit
from proxnav.geometry.pointing import continuous, q_a_cam_looking, q_between

DIRECTIONS = arrays(np.float64, 3, elements=st.floats(-1, 1)).filter(lambda v: np.linalg.norm(v) > 1e-3).map(unit)
X, Y, Z = np.eye(3)


@given(DIRECTIONS, DIRECTIONS)
def test_the_camera_looks_along_the_direction_with_up_in_the_upper_half(direction, up):
    R = quaternion.to_matrix(q_a_cam_looking(direction, up, np.roll(direction, 1) + np.array([2.0, 0.0, -3.0])))
    assert R[:, 2] == pytest.approx(direction, abs=1e-12)
    if np.linalg.norm(np.cross(direction, up)) > 1e-3:
        assert abs(R[:, 0] @ up) < 1e-9  # the right-hand axis is level
        assert -R[:, 1] @ up > 0.0


def test_the_fallback_decides_the_roll_when_up_is_along_the_view():
    R = quaternion.to_matrix(q_a_cam_looking(Z, -Z, X))
    assert -R[:, 1] == pytest.approx(X)


@given(DIRECTIONS, DIRECTIONS)
def test_the_smallest_rotation_turns_one_vector_into_the_other(a, b):
    q = q_between(a, b)
    assert quaternion.rotate(q, a) == pytest.approx(b, abs=1e-6)
    angle = np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)
    assert np.linalg.norm(quaternion.log(q)) == pytest.approx(angle, abs=1e-6)


def test_opposite_vectors_are_half_a_turn_apart():
    for v in (X, Y, -Z, unit(np.array([1.0, 2.0, -3.0]))):
        assert quaternion.rotate(q_between(v, -v), v) == pytest.approx(-v)


def test_continuous_removes_sign_flips_only(rng):
    phi = np.linspace(0.0, 4.0 * np.pi, 60)[:, None] * unit(rng.normal(size=3))
    q = quaternion.canonical(quaternion.exp(phi))
    smooth = continuous(q)
    assert (np.sum(smooth[1:] * smooth[:-1], axis=1) > 0.9).all()
    assert np.abs(smooth) == pytest.approx(np.abs(q))
