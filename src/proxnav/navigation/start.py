"""The first belief from one pose, and a new one after a loss."""

from dataclasses import replace

import numpy as np

from proxnav.geometry import quaternion, so3
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.geometry.types import Rotation3x3
from proxnav.navigation.belief import Belief, Tracking, Waiting
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.gates import ATTITUDE_GATE
from proxnav.navigation.kernels.attitude_control import control_error
from proxnav.navigation.kernels.error_state import corrected, reset
from proxnav.navigation.kernels.joseph import joseph
from proxnav.navigation.layout import N_POSE, Covariance, E, StateVector, X, diagonal
from proxnav.navigation.measurements import noise_of_pose
from proxnav.navigation.process_noise import SLOW_ACCELERATION
from proxnav.navigation.readings import PoseFix, StarFix

_LOOSE = 10.0
"""The pose opens the filter with so many times its own deviation; the same frame's measurement then counts in full.

So the lasting errors of the detector are shared between pose and camera states from the first frame on.
"""
_VELOCITY = 0.3
"""First uncertainty of the relative velocity [m/s]: far above that of any inspection."""
_RATE_WITHOUT_GYRO = 5e-3
"""First uncertainty of the camera's rate where no gyro measures it [rad/s]."""
_OLDEST_FIX_S = 5.0
_TURN_RATE = 5e-3  # rad/s, how fast the camera may have turned since the last star tracker fix


def star_to_start(belief: Belief) -> StarFix | None:
    """The fix that tells how the camera is turned, where a pose may start the filter now: without a state, or lost."""
    star = belief.memory.star
    wants = isinstance(belief, Waiting) or belief.is_lost
    return star if wants and star is not None and belief.t - star.t < _OLDEST_FIX_S else None


def started(belief: Belief, star: StarFix, fix: PoseFix, setup: FilterSetup) -> Tracking:
    """The belief about a pose; chaser attitude and gyro bias of a lost filter are kept."""
    x, P = _attitude_and_bias(belief, star, setup)
    _, _, R_eci_ric, rate = setup.orbit(belief.t)
    R_ric_cam = R_eci_ric.T @ quaternion.to_matrix(x[X.q_eci_cam])
    R_cam_target, held = quaternion.to_matrix(fix.q_cam_target), setup.config.target == "held"
    x[X.position], x[X.q_cam_target] = -R_ric_cam @ fix.t_cam_target_m, fix.q_cam_target
    x[X.rate] = R_cam_target.T @ R_ric_cam.T @ np.array([0.0, 0.0, rate]) if held else 0.0
    A = np.zeros((N_POSE, N_POSE))
    A[TRANSLATION, TRANSLATION], A[ROTATION, ROTATION] = -R_ric_cam, R_cam_target.T
    pose = setup.layout.places(E.position, E.attitude)
    P[np.ix_(pose, pose)] = A @ (_LOOSE**2 * fix.covariance) @ A.T
    _share_attitude(P, R_ric_cam @ so3.skew(fix.t_cam_target_m))
    _open_the_rest(P, setup)
    errors = np.zeros((N_POSE, N_POSE))  # of keypoints: their first frame says how large
    if setup.config.coupling == "loose":
        errors = setup.lasting_pose_share * noise_of_pose(fix, setup)
        P[E.pose_error, E.pose_error] = errors
    if held:
        x, P = _as_held(x, P, setup, belief.t)
    memory = replace(belief.memory, starts=belief.memory.starts + 1)
    streak = belief.star_streak if isinstance(belief, Tracking) else 0
    return Tracking(belief.t, x, P, belief.t, memory, errors, star_streak=streak)


def disagrees_with_control(belief: Belief, star: StarFix, fix: PoseFix, setup: FilterSetup) -> bool:
    """Whether a pose shows a controlled target in an attitude that it does not hold: another look of the same shape."""
    if setup.config.target == "free":
        return False
    x = np.zeros(setup.layout.n_states)
    x[X.q_eci_cam] = star.q_eci_cam if isinstance(belief, Waiting) else belief.x[X.q_eci_cam]
    x[X.q_cam_target] = fix.q_cam_target
    error, _ = control_error(x, setup.control(belief.t))
    R = quaternion.to_matrix(fix.q_cam_target)
    slack = setup.config.held.sigma**2 + (_TURN_RATE * (belief.t - star.t)) ** 2
    S = R.T @ fix.covariance[ROTATION, ROTATION] @ R + slack * np.eye(3)
    return bool(error @ np.linalg.solve(S, error) > ATTITUDE_GATE)


def _as_held(x: StateVector, P: Covariance, setup: FilterSetup, t: float) -> tuple[StateVector, Covariance]:
    """What control says about attitude and rate, as a measurement: its long-time mean and spread."""
    error, wanted = control_error(x, setup.control(t))
    R_cam_target, turn, sigma = quaternion.to_matrix(x[X.q_cam_target]), so3.skew(wanted), setup.config.held.sigma
    none, one = np.zeros((3, 3)), np.eye(3)
    H = np.block([[R_cam_target.T, one, none], [-turn @ R_cam_target.T, -turn, one]])
    R = np.diag(np.repeat([sigma, sigma * setup.config.held.frequency], 3) ** 2)
    seen = setup.layout.places(E.attitude_cam, E.attitude, E.rate)
    e, P, _ = joseph(P, seen, H, R, -np.concatenate([error, x[X.rate] - wanted]))
    return corrected(x, e), reset(P, e)


def _attitude_and_bias(belief: Belief, star: StarFix, setup: FilterSetup) -> tuple[StateVector, Covariance]:
    """State and covariance that know nothing but camera attitude and gyro bias."""
    layout, noise = setup.layout, setup.config.noise
    x, P = np.zeros(layout.n_states), np.zeros((layout.n_errors, layout.n_errors))
    if isinstance(belief, Waiting):
        x[X.q_eci_cam] = star.q_eci_cam
        P[diagonal(E.attitude_cam)] = 1e-6 + (_TURN_RATE * (belief.t - star.t)) ** 2
        P[diagonal(E.gyro_bias)] = (noise.gyro_bias if setup.has_gyro else _RATE_WITHOUT_GYRO) ** 2
        return x, P
    keep = layout.places(E.attitude_cam, E.gyro_bias)
    x[X.q_eci_cam], x[X.gyro_bias] = belief.x[X.q_eci_cam], belief.x[X.gyro_bias]
    P[np.ix_(keep, keep)] = belief.P[np.ix_(keep, keep)]
    return x, P


def _share_attitude(P: Covariance, B: Rotation3x3) -> None:
    """Position follows the camera's attitude error: dr += B dtheta_cam."""
    C, cross = P[E.attitude_cam, E.attitude_cam], B @ P[E.attitude_cam, E.gyro_bias]
    P[E.position, E.position] += B @ C @ B.T
    P[E.position, E.attitude_cam], P[E.attitude_cam, E.position] = B @ C, (B @ C).T
    P[E.position, E.gyro_bias], P[E.gyro_bias, E.position] = cross, cross.T


def _open_the_rest(P: Covariance, setup: FilterSetup) -> None:
    """First uncertainties of what a pose says nothing about."""
    noise = setup.config.noise
    P[diagonal(E.velocity)], P[diagonal(E.rate)] = _VELOCITY**2, noise.free_rate**2
    P[diagonal(E.acceleration)] = np.square(SLOW_ACCELERATION)
    P[diagonal(E.gnss_bias)] = noise.gnss_bias_m**2
    units = setup.layout.places(E.point_errors)
    P[units, units] = 1.0
