"""Constant rates on SE(3): what they predict, and what poses teach about them."""

import numpy as np

from proxnav.geometry import Pose, quaternion, so3
from proxnav.geometry.perturbation import difference
from proxnav.pose.track import Motion

POSE = Pose("cam", "target", quaternion.exp(np.array([0.3, -0.2, 0.5])), np.array([1.0, -0.5, 20.0]))
SIGMAS = np.diag([0.02, 0.02, 0.1, 0.01, 0.01, 0.01]) ** 2
V, W = np.array([0.05, -0.02, -0.1]), np.deg2rad([1.0, -2.0, 0.5])


def moving(t: float) -> Pose:
    """The pose after t seconds at constant rates."""
    return Pose.from_matrix("cam", "target", so3.exp(t * W) @ POSE.R, POSE.t_m + t * V)


def test_rates_are_learnt_from_poses_and_predict_the_next_one():
    motion = Motion.begun(0.0, POSE, SIGMAS)
    for t in range(1, 8):
        motion = motion.at(float(t)).corrected(moving(t), SIGMAS)
    np.testing.assert_allclose(motion.rate, np.r_[V, W], atol=3e-3)  # m/s, rad/s
    away = difference(motion.at(9.0).T_cam_target, moving(9.0))
    assert np.linalg.norm(away[3:]) < np.deg2rad(0.5)
    assert np.linalg.norm(away[:3]) < 0.05  # m


def test_what_is_not_measured_is_known_less_and_less():
    motion = Motion.begun(0.0, POSE, SIGMAS)
    sigmas = [motion.at(t).turn_sigma_rad for t in (0.0, 1.0, 3.0)]
    assert sigmas == sorted(sigmas)
    assert sigmas[2] > 3.0 * sigmas[0]


def test_covariances_stay_symmetric_and_positive():
    rng = np.random.default_rng(0)
    motion = Motion.begun(0.0, POSE, SIGMAS)
    for t in np.cumsum(rng.uniform(0.05, 5.0, 30)):
        motion = motion.at(float(t)).corrected(moving(t), SIGMAS)
        np.testing.assert_array_equal(motion.covariance, motion.covariance.T)
        assert np.linalg.eigvalsh(motion.covariance)[0] > 0.0


def test_a_pose_as_predicted_is_at_distance_zero():
    motion = Motion.begun(0.0, POSE, SIGMAS)
    assert motion.distance2(POSE, SIGMAS) == 0.0
    assert motion.distance2(moving(20.0), SIGMAS) > 100.0
