"""The first belief from one pose, and a new one after a loss."""

from dataclasses import replace

import numpy as np

from proxnav.geometry import quaternion, so3
from proxnav.navigation.belief import Belief, Scene
from proxnav.navigation.layout import CORE, FIXED, X_FIXED

_LOOSE = 10.0
"""The pose opens the filter with so many times its own deviation; the same frame's measurement then counts in full.

So the lasting errors of the detector are shared between pose and camera states from the first frame on.
"""
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
    x[14:17] = R_cam_target.T @ R_ric_cam.T @ np.array([0.0, 0.0, rate]) if scene.config.target_rate == "lvlh" else 0.0
    A = np.zeros((6, 6))
    A[:3, :3], A[3:, 3:] = -R_ric_cam, R_cam_target.T
    rows = [0, 1, 2, 9, 10, 11]
    P[np.ix_(rows, rows)] = A @ (_LOOSE**2 * cov) @ A.T
    _share_attitude(P, R_ric_cam @ so3.skew(t_m))
    noise = scene.config.noise
    for first, sigma in ((3, noise.velocity), (12, noise.target_rate), (18, noise.slow_acceleration)):
        P[range(first, first + 3), range(first, first + 3)] = sigma**2
    P[range(CORE, FIXED), range(CORE, FIXED)] = noise.gnss_bias_m**2
    P[range(FIXED, len(P)), range(FIXED, len(P))] = 1.0
    return replace(
        belief, x=x, P=P, frames=(), camera_t=belief.t, starts=belief.starts + 1, is_lost=False, gnss_streak=0
    )


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
