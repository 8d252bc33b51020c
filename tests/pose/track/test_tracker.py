"""The tracker on painted pictures of a box that turns: what it follows, mends, and calls lost."""

import numpy as np
import pytest

from boxcraft import boxcraft
from painted_box import CAMERA, painted
from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion, so3
from proxnav.geometry.perturbation import moved
from proxnav.geometry.pose_errors import pose_errors
from proxnav.pose.align import Prior
from proxnav.pose.track import Start, Tracker
from proxnav.pose.track.search import STEP_RAD, searched, turns

FIRST = Pose("cam", "target", quaternion.exp(np.array([0.5, -0.7, 0.3])), np.array([0.2, -0.1, 9.0]))
TURN = np.deg2rad([1.5, -2.0, 1.0])
EMPTY = np.random.default_rng(3).integers(8, 16, (CAMERA.height, CAMERA.width), dtype=np.uint8)


def turned(k: float) -> Pose:
    """The box after k frames at 2.7 deg a frame, slowly coming nearer."""
    return Pose.from_matrix("cam", "target", so3.exp(k * TURN) @ FIRST.R, FIRST.t_m - (0.0, 0.0, 0.02 * k))


def is_right(T: Pose | None, truth: Pose) -> bool:
    """Within 2 % of range and 2 deg."""
    if T is None:
        return False
    errors = pose_errors(T, truth)
    return errors.e_tn < 0.02 and errors.e_r_rad < np.deg2rad(2.0)


def begun(off_deg: float = 0.0, k: float = 0.0, sigma_deg: float = 5.0) -> Tracker:
    start = moved(turned(k), np.r_[np.zeros(3), np.deg2rad(off_deg) * np.array([0.6, 0.0, 0.8])])
    return Tracker.from_pose(boxcraft(), start, k, Start(np.deg2rad(sigma_deg)))


def test_a_turning_box_is_followed_through_every_frame():
    tracker = begun(off_deg=4.0)
    found = [tracker(painted(turned(k)), CAMERA, float(k)).T_cam_target for k in range(14)]
    assert all(is_right(T, turned(k)) for k, T in enumerate(found))
    np.testing.assert_allclose(tracker.motion.rate[3:], TURN, atol=np.deg2rad(0.3))  # rad/s


def test_a_start_that_is_fifteen_degrees_off_is_mended_where_it_is_said_to_be_vague():
    assert is_right(begun(15.0, sigma_deg=10.0)(painted(FIRST), CAMERA, 0.0).T_cam_target, FIRST)


def test_an_image_without_the_target_is_lost_and_has_no_pose():
    tracker = begun()
    assert tracker(painted(turned(0)), CAMERA, 0.0).status == "ok"
    result = tracker(EMPTY, CAMERA, 1.0)
    assert (result.status, result.T_cam_target, tracker.misses) == ("lost", None, 1)


def test_a_target_that_comes_back_is_found_where_its_motion_led():
    tracker = begun()
    for k in range(6):
        tracker(painted(turned(k)), CAMERA, float(k))
    for k in range(6, 9):
        assert tracker(EMPTY, CAMERA, float(k)).T_cam_target is None
    assert is_right(tracker(painted(turned(9)), CAMERA, 9.0).T_cam_target, turned(9))
    assert tracker.misses == 0


def test_a_jump_that_no_motion_explains_is_no_pose():
    tracker = begun()
    for k in range(6):
        tracker(painted(turned(k)), CAMERA, float(k))
    jumped = moved(turned(6), np.array([0.0, 0.0, 6.0, 0.0, 0.9, 0.0]))
    assert tracker(painted(jumped), CAMERA, 6.0).T_cam_target is None


def test_an_image_of_another_size_is_refused():
    with pytest.raises(InputError, match="the image is 10x10 px"):
        begun()(np.zeros((10, 10), np.uint8), CAMERA, 0.0)


def test_a_search_tries_the_middle_first_and_nothing_beyond_its_reach():
    tried = turns(2.0 * STEP_RAD)
    assert tried[0].tolist() == [0.0, 0.0, 0.0]
    assert len(tried) == 33
    assert np.linalg.norm(tried, axis=1).max() <= 2.0 * STEP_RAD + 1e-9


def test_a_search_outside_of_the_image_finds_nothing():
    aside = Pose("cam", "target", FIRST.q_wxyz, np.array([50.0, 0.0, 9.0]))
    prior = Prior.of(aside, np.diag([0.1] * 3 + [0.1] * 3) ** 2)
    assert searched(painted(FIRST), CAMERA, boxcraft(), prior, 0.3) is None
