"""The first belief from one pose, and a new one after a loss."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion, so3
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.geometry.types import Rotation3x3, Vector3
from proxnav.navigation.belief import Belief, Memory, Restart, Tracking, Waiting, nav_state
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.gates import ATTITUDE_GATE
from proxnav.navigation.kernels.attitude_control import control_error
from proxnav.navigation.kernels.error_state import corrected, reset
from proxnav.navigation.kernels.joseph import joseph
from proxnav.navigation.layout import GEOMETRY, N_GEOMETRY, N_POSE, Covariance, E, StateVector, X, diagonal
from proxnav.navigation.learnt_noise import lasting_share
from proxnav.navigation.measurements import noise_of_pose
from proxnav.navigation.process_noise import TURN_SHARE
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
    """The belief about a pose; what a lost filter knows of camera attitude, gyro bias and geometry is kept."""
    x, P = _kept(belief, star, setup)
    _, _, R_eci_ric, rate = setup.orbit(belief.t)
    R_ric_cam, R_mount = R_eci_ric.T @ quaternion.to_matrix(x[X.q_eci_cam]), so3.exp(x[X.misalignment])
    R_cam_target, held = R_mount @ quaternion.to_matrix(fix.q_cam_target), setup.config.target == "held"
    between = x[X.chaser_centre] - R_cam_target @ x[X.target_centre] - R_mount @ fix.t_cam_target_m
    x[X.position], x[X.q_cam_target] = R_ric_cam @ between, quaternion.from_matrix(R_cam_target)
    x[X.rate] = R_cam_target.T @ R_ric_cam.T @ np.array([0.0, 0.0, rate]) if held else 0.0
    _open_the_rest(P, belief.memory, setup)
    _open_pose(P, _start_errors(fix, R_ric_cam, R_mount, between, x[X.target_centre]), fix, setup)
    errors = np.zeros((N_POSE, N_POSE))  # of keypoints: their first frame says how large
    if setup.config.coupling == "loose":
        errors = lasting_share(belief.memory, setup) * noise_of_pose(fix, setup)
        P[E.pose_error, E.pose_error] = errors
    if held:
        x, P = _as_held(x, P, setup, belief.t)
    memory = replace(belief.memory, starts=belief.memory.starts + 1, restarts=_restarts(belief, fix, setup))
    streak = belief.star_streak if isinstance(belief, Tracking) else 0
    return Tracking(belief.t, x, P, belief.t, memory, errors, star_streak=streak)


class _StartErrors(NamedTuple):
    """Errors of position (RIC) and attitude (target axes) that a pose starts, by what they come from."""

    pose: Float[np.ndarray, "6 6"]
    """(dt, dr) of the pose in camera axes."""
    attitude_cam: Float[np.ndarray, "6 3"]
    geometry: Float[np.ndarray, "6 10"]
    """In the order of `E.geometry`."""


def _start_errors(
    fix: PoseFix, R_ric_cam: Rotation3x3, R_mount: Rotation3x3, between: Vector3, centre: Vector3
) -> _StartErrors:
    """From position = R_ric_cam between and between = own centre - R_mount (R_pose centre + t)."""
    R_pose, R_seen = quaternion.to_matrix(fix.q_cam_target), R_ric_cam @ R_mount
    pose, cam, geometry = np.zeros((N_POSE, N_POSE)), np.zeros((N_POSE, 3)), np.zeros((N_POSE, N_GEOMETRY))
    pose[TRANSLATION, TRANSLATION], pose[TRANSLATION, ROTATION] = -R_seen, R_seen @ so3.skew(R_pose @ centre)
    pose[ROTATION, ROTATION] = R_pose.T
    cam[TRANSLATION] = -R_ric_cam @ so3.skew(between)
    geometry[TRANSLATION, GEOMETRY.target_centre] = -R_seen @ R_pose
    geometry[TRANSLATION, GEOMETRY.chaser_centre] = R_ric_cam
    geometry[TRANSLATION, GEOMETRY.misalignment] = R_seen @ so3.skew(R_pose @ centre + fix.t_cam_target_m)
    geometry[ROTATION, GEOMETRY.misalignment] = R_pose.T
    return _StartErrors(pose, cam, geometry)


def _open_pose(P: Covariance, errors: _StartErrors, fix: PoseFix, setup: FilterSetup) -> None:
    """Covariance of position and attitude, and with all that they come from."""
    J = np.zeros((N_POSE, len(P)))
    J[:, E.attitude_cam], J[:, E.geometry] = errors.attitude_cam, errors.geometry
    pose, across = setup.layout.places(E.position, E.attitude), J @ P
    P[pose, :], P[:, pose] = across, across.T
    P[np.ix_(pose, pose)] = across @ J.T + errors.pose @ (_LOOSE**2 * fix.covariance) @ errors.pose.T


def _restarts(belief: Belief, fix: PoseFix, setup: FilterSetup) -> tuple[Restart, ...]:
    if isinstance(belief, Waiting):
        return belief.memory.restarts
    before = nav_state(belief, setup)
    moved = float(np.linalg.norm(fix.t_cam_target_m - before.t_cam_target_m))
    turned = float(quaternion.angle_between(before.q_cam_target, fix.q_cam_target))
    again = Restart(belief.t, belief.frames.count(False), len(belief.frames), moved, turned)
    return (*belief.memory.restarts, again)


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


def _kept(belief: Belief, star: StarFix, setup: FilterSetup) -> tuple[StateVector, Covariance]:
    """State and covariance that know nothing but camera attitude, gyro bias and geometry."""
    layout, noise, config = setup.layout, setup.config.noise, setup.config.geometry
    x, P = np.zeros(layout.n_states), np.zeros((layout.n_errors, layout.n_errors))
    if isinstance(belief, Waiting):
        x[X.q_eci_cam] = star.q_eci_cam
        x[X.target_centre], x[X.chaser_centre] = config.target_centre_m, config.chaser_centre_cam_m
        P[diagonal(E.attitude_cam)] = 1e-6 + (_TURN_RATE * (belief.t - star.t)) ** 2
        P[diagonal(E.gyro_bias)] = (noise.gyro_bias if setup.has_gyro else _RATE_WITHOUT_GYRO) ** 2
        P[diagonal(E.geometry)] = np.square(config.sigmas)
        return x, P
    keep = layout.places(E.attitude_cam, E.gyro_bias, E.geometry)
    for block in (X.q_eci_cam, X.gyro_bias, X.target_centre, X.chaser_centre, X.misalignment, X.clock):
        x[block] = belief.x[block]
    P[np.ix_(keep, keep)] = belief.P[np.ix_(keep, keep)]
    return x, P


def _open_the_rest(P: Covariance, memory: Memory, setup: FilterSetup) -> None:
    """First uncertainties of what a pose says nothing about."""
    noise = setup.config.noise
    P[diagonal(E.velocity)], P[diagonal(E.rate)] = _VELOCITY**2, noise.free_rate**2
    P[diagonal(E.acceleration)] = memory.slow_variance
    P[diagonal(E.turn_acceleration)] = (3.0 * setup.noise[TURN_SHARE] * noise.free_rate**2) ** 2
    P[diagonal(E.gnss_bias)] = noise.gnss_bias_m**2
    units = setup.layout.places(E.point_errors)
    P[units, units] = 1.0
