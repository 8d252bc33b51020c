"""The first belief from one pose, and a new one after a loss."""

from dataclasses import replace

import numpy as np
from scipy.stats import chi2

from proxnav.geometry import quaternion, so3
from proxnav.navigation.belief import Belief, Scene
from proxnav.navigation.kernels.prediction import corrected, held_motion
from proxnav.navigation.kernels.update import joseph, reset
from proxnav.navigation.layout import CORE, FIXED, X_FIXED
from proxnav.navigation.observe import in_target_axes

_LOOSE = 10.0
"""The pose opens the filter with so many times its own deviation; the same frame's measurement then counts in full.

So the lasting errors of the detector are shared between pose and camera states from the first frame on.
"""
_HELD_GATE = float(chi2.ppf(0.9999, 3))
_ATTITUDES = np.arange(6, 15)
_OLDEST_FIX_S = 5.0
_TURN_RATE = 5e-3  # rad/s, how fast the camera may have turned since the last star tracker fix


def can_start(belief: Belief) -> bool:
    """Whether a pose may start the filter now: it has no state, or a lost one, and knows how the camera is turned."""
    return (belief.x is None or belief.is_lost) and belief.fix is not None and belief.t - belief.fix[0] < _OLDEST_FIX_S


def start(belief: Belief, q_cam_target: np.ndarray, t_m: np.ndarray, cov: np.ndarray, scene: Scene) -> Belief:
    """The belief about a pose; chaser attitude and gyro bias of a lost filter are kept."""
    assert belief.fix is not None
    x, P = _attitude_and_bias(belief, scene)
    R_eci_ric, rate = scene.orbit(belief.t)[2:]
    R_ric_cam = R_eci_ric.T @ quaternion.to_matrix(x[6:10])
    R_cam_target = quaternion.to_matrix(q_cam_target)
    x[:3], x[10:14] = -R_ric_cam @ t_m, q_cam_target
    x[14:17] = R_cam_target.T @ R_ric_cam.T @ np.array([0.0, 0.0, rate]) if scene.config.target == "held" else 0.0
    A = np.zeros((6, 6))
    A[:3, :3], A[3:, 3:] = -R_ric_cam, R_cam_target.T
    rows = [0, 1, 2, 9, 10, 11]
    P[np.ix_(rows, rows)] = A @ (_LOOSE**2 * cov) @ A.T
    _share_attitude(P, R_ric_cam @ so3.skew(t_m))
    noise = scene.config.noise
    P[range(3, 6), range(3, 6)], P[range(12, 15), range(12, 15)] = noise.velocity**2, noise.free_rate**2
    P[range(18, 21), range(18, 21)] = np.square(noise.slow_acceleration)
    P[range(CORE, FIXED), range(CORE, FIXED)] = noise.gnss_bias_m**2
    P[range(FIXED, len(P) - 6), range(FIXED, len(P) - 6)] = 1.0
    errors = np.zeros((6, 6))  # of keypoints: their first frame says how large
    if scene.config.coupling == "loose":
        P[-6:, -6:] = errors = scene.lasting_pose_share * in_target_axes(cov, q_cam_target)
    if scene.config.target == "held":
        x, P = _as_held(x, P, scene, belief.t)
    return replace(
        belief,
        x=x,
        P=P,
        pose_errors=errors,
        frames=(),
        camera_t=belief.t,
        starts=belief.starts + 1,
        is_lost=False,
        gnss_streak=0,
    )


def disagrees_with_control(belief: Belief, q_cam_target: np.ndarray, cov: np.ndarray, scene: Scene) -> bool:
    """Whether a pose shows a controlled target in an attitude that it does not hold: another look of the same shape."""
    if scene.config.target == "free":
        return False
    assert belief.fix is not None
    x = np.zeros(X_FIXED)
    x[6:10] = belief.fix[1] if belief.x is None else belief.x[6:10]
    x[10:14] = q_cam_target
    error, _ = held_motion(x, scene.held(belief.t))
    R = quaternion.to_matrix(q_cam_target)
    slack = np.deg2rad(scene.config.held.sigma_deg) ** 2 + (_TURN_RATE * (belief.t - belief.fix[0])) ** 2
    return bool(error @ np.linalg.solve(R.T @ cov[3:, 3:] @ R + slack * np.eye(3), error) > _HELD_GATE)


def _as_held(x: np.ndarray, P: np.ndarray, scene: Scene, t: float) -> tuple[np.ndarray, np.ndarray]:
    """What control says about attitude and rate, as a measurement: its long-time mean and spread."""
    held, sigma = scene.held(t), np.deg2rad(scene.config.held.sigma_deg)
    error, wanted = held_motion(x, held)
    R_cam_target, turn = quaternion.to_matrix(x[10:14]), so3.skew(wanted)
    H = np.zeros((6, 9))
    H[:3, :3], H[:3, 3:6] = R_cam_target.T, np.eye(3)
    H[3:, :3], H[3:, 3:6], H[3:, 6:] = -turn @ R_cam_target.T, -turn, np.eye(3)
    R = np.diag(np.repeat([sigma, sigma * scene.config.held.frequency], 3) ** 2)
    e, P, _ = joseph(P, _ATTITUDES, H, R, -np.concatenate([error, x[14:17] - wanted]))
    return corrected(x, e), reset(P, e)


def _attitude_and_bias(belief: Belief, scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """State and covariance that know nothing but camera attitude and gyro bias."""
    n = FIXED + scene.camera_errors
    x, P = np.zeros(X_FIXED + scene.camera_errors), np.zeros((n, n))
    keep = [6, 7, 8, 15, 16, 17]
    if belief.x is not None and belief.P is not None:
        x[6:10], x[17:20] = belief.x[6:10], belief.x[17:20]
        P[np.ix_(keep, keep)] = belief.P[np.ix_(keep, keep)]
        return x, P
    assert belief.fix is not None
    t, q = belief.fix
    noise = scene.config.noise
    x[6:10] = q
    P[range(6, 9), range(6, 9)] = 1e-6 + (_TURN_RATE * (belief.t - t)) ** 2
    P[range(15, 18), range(15, 18)] = (noise.gyro_bias if scene.has_gyro else noise.rate_without_gyro) ** 2
    return x, P


def _share_attitude(P: np.ndarray, B: np.ndarray) -> None:
    """Position follows the camera's attitude error: dr += B dtheta_cam."""
    C = P[6:9, 6:9]
    P[:3, :3] += B @ C @ B.T
    P[:3, 6:9], P[6:9, :3] = B @ C, (B @ C).T
    cross = B @ P[6:9, 15:18]
    P[:3, 15:18], P[15:18, :3] = cross, cross.T
