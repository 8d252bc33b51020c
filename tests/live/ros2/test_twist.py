"""The twist is that of a target that moves steadily."""

import numpy as np

from proxnav.geometry import Pose, quaternion
from proxnav.live.ros2.camera_rate import CameraRate
from proxnav.live.ros2.twist import MovingPose, twist_between

COVARIANCE = np.diag([1e-4, 1e-4, 4e-4, 1e-6, 1e-6, 1e-6])
RATE = np.array([0.01, -0.02, 0.03])
VELOCITY = np.array([0.1, -0.2, -0.3])


def at(t: float) -> MovingPose:
    """A target that turns about its own axes and drifts past a camera at rest."""
    T = Pose.from_wxyz("cam", "target", quaternion.exp(RATE * t), np.array([0.0, 1.0, 20.0]) + VELOCITY * t)
    return MovingPose(t, T, COVARIANCE)


def test_the_twist_of_a_steady_motion_is_found_in_target_axes() -> None:
    twist, R = twist_between(at(0.0), at(0.5)), at(0.5).T_cam_target.R
    np.testing.assert_allclose(twist.angular_radps, RATE, atol=1e-9)
    np.testing.assert_allclose(R @ twist.linear_mps, VELOCITY, atol=1e-9)
    np.testing.assert_allclose(np.trace(twist.covariance[:3, :3]), 2.0 * 6e-4 / 0.25, rtol=1e-9)


def test_the_gyro_takes_the_cameras_own_turn_out_of_a_target_at_rest() -> None:
    turning, dt = np.array([0.0, 0.02, 0.0]), 0.1
    seen = [
        MovingPose(t, Pose.from_wxyz("cam", "world", quaternion.exp(-turning * t), np.zeros(3)) @ STILL, COVARIANCE)
        for t in (0.0, dt)
    ]
    rate = CameraRate()
    for t in np.linspace(0.0, dt, 11).tolist():
        rate.take(t, turning)
    plain = twist_between(*seen)
    assert np.linalg.norm(plain.linear_mps) > 0.3  # m/s, all of it apparent
    twist = rate.taken_out(plain, *seen)
    np.testing.assert_allclose(twist.linear_mps, 0.0, atol=1e-5)
    np.testing.assert_allclose(twist.angular_radps, 0.0, atol=1e-9)


STILL = Pose.from_wxyz("world", "target", [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 20.0])


def test_without_readings_of_the_interval_the_twist_stays_as_it_is() -> None:
    rate = CameraRate()
    rate.take(100.0, RATE)
    twist = twist_between(at(0.0), at(0.5))
    assert rate.taken_out(twist, at(0.0), at(0.5)) is twist
