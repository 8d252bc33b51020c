"""Poses: group axioms with frame names, refusal of wrong compositions, immutability."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion

VECTORS = arrays(np.float64, 3, elements=st.floats(-100, 100))
QUATERNIONS = arrays(np.float64, 3, elements=st.floats(-2, 2)).map(quaternion.exp)


PLACES = st.tuples(QUATERNIONS, VECTORS)


def pose(a, b, place):
    return Pose.from_wxyz(a, b, *place)


def assert_same(P, Q, atol=1e-9):
    assert P.frames == Q.frames
    assert P.matrix() == pytest.approx(Q.matrix(), abs=atol)


@given(PLACES, PLACES, PLACES)
def test_composition_associates(p, q, r):
    P, Q, R = pose("a", "b", p), pose("b", "c", q), pose("c", "d", r)
    assert_same((P @ Q) @ R, P @ (Q @ R))


@given(PLACES)
def test_inverse_composes_to_identity(p):
    P = pose("a", "b", p)
    assert_same(P @ P.inverse(), Pose.identity("a", "a"))
    assert_same(P.inverse() @ P, Pose.identity("b", "b"))
    assert_same(P.inverse().inverse(), P)


@given(PLACES, PLACES, VECTORS)
def test_composition_is_the_product_of_matrices_and_of_maps(p, q, point):
    P, Q = pose("a", "b", p), pose("b", "c", q)
    assert (P @ Q).matrix() == pytest.approx(P.matrix() @ Q.matrix(), abs=1e-9)
    assert (P @ Q) @ point == pytest.approx(P @ (Q @ point), abs=1e-9)


def test_a_pose_by_hand():
    T_cam_target = Pose.from_wxyz("cam", "target", [np.sqrt(0.5), 0, 0, np.sqrt(0.5)], [0, 0, 10])
    assert T_cam_target @ np.array([1.0, 0.0, 0.0]) == pytest.approx([0.0, 1.0, 10.0])
    assert T_cam_target.inverse().t_m == pytest.approx([0.0, 0.0, -10.0])
    assert (T_cam_target @ np.zeros((5, 2, 3))).shape == (5, 2, 3)


def test_frames_that_do_not_meet_are_refused():
    P, Q = Pose.identity("cam", "target"), Pose.identity("panel", "target")
    with pytest.raises(InputError, match=r"inner frames differ .'target' and 'panel'."):
        P @ Q
    assert (P @ Q.inverse()).frames == ("cam", "panel")


@given(PLACES)
def test_matrices_go_there_and_back(p):
    P = pose("a", "b", p)
    assert_same(Pose.from_matrix("a", "b", P.R, P.t_m), P, atol=1e-7)


@pytest.mark.parametrize(
    "R", [np.eye(3) * 1.01, np.diag([1.0, 1.0, -1.0]), np.zeros((3, 3)), np.full((3, 3), np.nan), np.eye(4)]
)
def test_matrices_that_are_no_rotations_are_refused(R):
    with pytest.raises(InputError, match="R_a_b is not a rotation matrix"):
        Pose.from_matrix("a", "b", R, np.zeros(3))


@pytest.mark.parametrize("q", [(1, 1, 0, 0), (0, 0, 0, 0), (np.nan, 0, 0, 0), (0.999, 0, 0, 0)])
def test_quaternions_that_are_not_unit_are_refused(q):
    with pytest.raises(InputError, match="needs a unit quaternion wxyz"):
        Pose.from_wxyz("a", "b", q, np.zeros(3))


@pytest.mark.parametrize("t", [(np.inf, 0, 0), (0, np.nan, 0), (0, 0)])
def test_translations_must_be_three_finite_numbers(t):
    with pytest.raises(InputError, match=r"t_m|finite translation"):
        Pose.from_wxyz("a", "b", (1, 0, 0, 0), t)


def test_a_pose_does_not_share_or_allow_changes_of_its_arrays():
    t = np.zeros(3)
    P = Pose.from_wxyz("a", "b", (1, 0, 0, 0), t)
    t[0] = 5.0
    assert P.t_m[0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        P.t_m[0] = 1.0
    with pytest.raises(AttributeError):
        P.t_m = t  # pyright: ignore


def test_slightly_rounded_quaternions_are_normalised():
    P = Pose.from_wxyz("a", "b", (0.70711, 0.0, 0.0, 0.70711), np.zeros(3))
    assert np.linalg.norm(P.q_wxyz) == pytest.approx(1.0, abs=1e-15)
