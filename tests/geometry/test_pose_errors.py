"""Errors of one pose, computed by hand."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.geometry.pose_errors import pose_errors


def pose(t_m: list[float], turn_deg: float = 0.0) -> Pose:
    half = np.radians(turn_deg) / 2.0
    return Pose.from_wxyz("cam", "target", [np.cos(half), np.sin(half), 0.0, 0.0], t_m)


def test_errors_by_hand() -> None:
    errors = pose_errors(pose([1.3, -2.0, 20.4], 9.0), pose([1.0, -2.0, 20.0]))
    np.testing.assert_allclose(errors.e_t_m, [0.3, 0.0, 0.4], atol=1e-12)  # m
    assert errors.e_t_norm_m == pytest.approx(0.5, abs=1e-12)
    assert errors.e_tn == pytest.approx(0.5 / np.sqrt(1.0 + 4.0 + 400.0), rel=1e-12)
    assert errors.e_r_rad == pytest.approx(np.pi / 20.0, abs=1e-12)
    assert errors.e_c == pytest.approx(errors.e_tn + np.pi / 20.0, abs=1e-12)


def test_attitude_error_is_exact_where_arccos_is_not() -> None:
    errors = pose_errors(pose([0.0, 0.0, 10.0], 1e-7), pose([0.0, 0.0, 10.0]))
    assert errors.e_r_rad == pytest.approx(np.radians(1e-7), rel=1e-6)


def test_sign_of_the_quaternion_does_not_matter() -> None:
    T = pose([0.0, 0.0, 10.0], 40.0)
    negative = Pose.from_wxyz("cam", "target", -T.q_wxyz, T.t_m)
    assert pose_errors(negative, T).e_c == pytest.approx(0.0, abs=1e-12)


@given(st.integers(0, 10_000))
@settings(max_examples=30, deadline=None)
def test_attitude_error_does_not_depend_on_the_targets_frame(seed: int) -> None:
    rng = np.random.default_rng(seed)
    q_est, q_true, q_frame = quaternion.random(rng, 3)
    turned = Pose.from_wxyz("target", "panel", q_frame, [0.0, 0.0, 0.0])
    T_est = Pose.from_wxyz("cam", "target", q_est, [0.0, 0.0, 10.0])
    T_true = Pose.from_wxyz("cam", "target", q_true, [0.0, 1.0, 10.0])
    a, b = pose_errors(T_est, T_true), pose_errors(T_est @ turned, T_true @ turned)
    assert a.e_r_rad == pytest.approx(b.e_r_rad, abs=1e-9)


def test_other_frames_and_zero_range_are_refused() -> None:
    T = pose([0.0, 0.0, 10.0])
    with pytest.raises(InputError, match="T_target_cam"):
        pose_errors(T.inverse(), T)
    with pytest.raises(InputError, match="true range is 0 m"):
        pose_errors(T, pose([0.0, 0.0, 0.0]))
