"""Measurements into the belief: gates first, then Joseph-form updates. Each gives the new belief and a verdict."""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.stats import chi2

from proxnav.geometry import quaternion, so3
from proxnav.navigation.belief import Belief, Scene
from proxnav.navigation.kernels.prediction import corrected
from proxnav.navigation.kernels.update import ACCEPTED, joseph, keypoint_update, reset
from proxnav.navigation.layout import FIXED

Outcome = Literal["accepted", "gated", "no_points", "not_started", "started", "late", "duplicate", "ahead", "invalid"]


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a measurement."""

    outcome: Outcome
    nis: float = float("nan")
    """Normalised innovation squared, `dof` on average when the filter is honest."""
    dof: int = 0
    gated_points: int = 0
    """Keypoints of an accepted frame that were refused by themselves."""


def take_keypoints(belief: Belief, pixels: np.ndarray, cov: np.ndarray, scene: Scene) -> tuple[Belief, Verdict]:
    """A frame of keypoints (k, 2) with covariances (k, 2, 2); NaN where a point was not found."""
    index = np.flatnonzero(np.isfinite(pixels[:, 0]) & np.isfinite(cov[:, 0, 0]))
    if belief.x is None or belief.P is None:
        return belief, Verdict("not_started")
    if len(index) == 0:
        return belief, Verdict("no_points")
    config = scene.config
    x, P, outcome, used, nis = keypoint_update(
        belief.x, belief.P, pixels, cov, scene.points_m, index, scene.orbit(belief.t)[2], scene.lens,
        config.noise.camera_share, _gate(config.gates.keypoint, 2), scene.frame_gates, config.gates.least_share,
    )  # fmt: skip
    if outcome != ACCEPTED:
        return _frame_refused(belief, scene), Verdict("gated", float(nis))
    count = int(used.sum())
    return _frame_accepted(belief, x, P, scene), Verdict("accepted", float(nis), 2 * count, len(index) - count)


def take_pose(
    belief: Belief, q_cam_target: np.ndarray, t_m: np.ndarray, cov: np.ndarray, scene: Scene
) -> tuple[Belief, Verdict]:
    """A pose of the pose solver with its covariance (dt, dr) in camera axes; part of it lasts from frame to frame."""
    if belief.x is None or belief.P is None:
        return belief, Verdict("not_started")
    x, share = belief.x, scene.config.noise.camera_share
    H, t_hat = pose_model(x, len(belief.P), scene.orbit(belief.t)[2])
    root = np.linalg.cholesky(share * cov) if share > 0.0 else np.zeros((6, 6))
    H[:, FIXED : FIXED + 6] = root
    turn = quaternion.log(quaternion.multiply(q_cam_target, quaternion.conjugate(x[10:14])))
    y = np.concatenate([t_m - t_hat, turn]) - root @ x[26:32]
    e, P, nis = joseph(belief.P, H, (1.0 - share) * cov, y)
    if not nis <= _gate(scene.config.gates.frame, 6):
        return _frame_refused(belief, scene), Verdict("gated", float(nis))
    return _frame_accepted(belief, corrected(x, e), reset(P, e), scene), Verdict("accepted", float(nis), 6)


def take_star_fix(belief: Belief, t: float, q: np.ndarray, sigma: np.ndarray, scene: Scene) -> tuple[Belief, Verdict]:
    """Attitude of the camera; a row of refusals says that the gyro is not what it was: its bias starts anew."""
    belief = replace(belief, fix=(t, q))
    if belief.x is None or belief.P is None:
        return belief, Verdict("not_started")
    H = np.zeros((3, len(belief.P)))
    H[:, 6:9] = np.eye(3)
    y = quaternion.log(quaternion.multiply(quaternion.conjugate(belief.x[6:10]), q))
    e, P, nis = joseph(belief.P, H, np.diag(sigma**2), y)
    if nis <= _gate(scene.config.gates.fix, 3):
        return replace(belief, x=corrected(belief.x, e), P=reset(P, e), star_streak=0), Verdict(
            "accepted", float(nis), 3
        )
    belief = replace(belief, star_streak=belief.star_streak + 1)
    if belief.star_streak < scene.config.loss.fix_streak:
        return belief, Verdict("gated", float(nis))
    return replace(belief, P=_loosened_gyro(belief, scene, y), star_streak=0), Verdict("gated", float(nis))


def take_gnss(
    belief: Belief, position: np.ndarray, velocity: np.ndarray, sigmas: tuple[float, float], scene: Scene
) -> tuple[Belief, Verdict]:
    """Baseline between the antennas and its rate, ECI axes. A row of refusals: the GNSS bias starts anew."""
    if belief.x is None or belief.P is None:
        return belief, Verdict("not_started")
    H, h = gnss_model(belief.x, len(belief.P), scene, belief.t)
    R = np.diag(np.repeat(np.square(sigmas), 3))
    e, P, nis = joseph(belief.P, H, R, np.concatenate([position, velocity]) - h)
    if nis <= _gate(scene.config.gates.fix, 6):
        return replace(belief, x=corrected(belief.x, e), P=reset(P, e), gnss_streak=0), Verdict(
            "accepted", float(nis), 6
        )
    belief = replace(belief, gnss_streak=belief.gnss_streak + 1)
    if belief.gnss_streak < scene.config.loss.fix_streak:
        return belief, Verdict("gated", float(nis))
    assert belief.P is not None
    P = decoupled(belief.P, range(21, 24), 10.0 * scene.config.noise.gnss_bias_m)
    return replace(belief, P=P, gnss_streak=0), Verdict("gated", float(nis))


def pose_model(x: np.ndarray, n: int, R_eci_ric: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(H of (dt, dr) in camera axes, predicted t_cam_target)."""
    R_cam_ric = quaternion.to_matrix(x[6:10]).T @ R_eci_ric
    t_hat = -R_cam_ric @ x[:3]
    H = np.zeros((6, n))
    H[:3, :3], H[:3, 6:9], H[3:, 9:12] = -R_cam_ric, so3.skew(t_hat), quaternion.to_matrix(x[10:14])
    return H, t_hat


def gnss_model(x: np.ndarray, n: int, scene: Scene, t: float) -> tuple[np.ndarray, np.ndarray]:
    """(H, prediction) of the baseline between the antennas and its rate in ECI axes.

    The antennas' own turning about the centres of mass (mm/s) is left out.
    """
    _, _, R, rate = scene.orbit(t)
    R_ec, R_ct = quaternion.to_matrix(x[6:10]), quaternion.to_matrix(x[10:14])
    own, other = np.array(scene.config.chaser_antenna_cam_m), np.array(scene.config.target_antenna_target_m)
    W = so3.skew(np.array([0.0, 0.0, rate]))
    H = np.zeros((6, n))
    H[:3, :3], H[:3, 21:24] = R, np.eye(3)
    H[:3, 6:9] = -R_ec @ so3.skew(own - R_ct @ other)
    H[:3, 9:12] = R_ec @ R_ct @ so3.skew(other)
    H[3:, :3], H[3:, 3:6] = R @ W, R
    h = np.concatenate([R @ x[:3] + R_ec @ (own - R_ct @ other) + x[23:26], R @ (x[3:6] + W @ x[:3])])
    return H, h


def decoupled(P: np.ndarray, index: range, sigma: float) -> np.ndarray:
    """P with the errors `index` unknown to `sigma` and independent of the others."""
    out = P.copy()
    k = list(index)
    out[k, :], out[:, k] = 0.0, 0.0
    out[k, k] = sigma**2
    return out


def _loosened_gyro(belief: Belief, scene: Scene, y: np.ndarray) -> np.ndarray:
    """Attitude as wrong as the fix says, bias as unknown as at the start; the relative attitude keeps its own."""
    assert belief.P is not None
    P = decoupled(belief.P, range(15, 18), 10.0 * scene.config.noise.gyro_bias)
    k = range(6, 9)
    P[k, k] += 4.0 * float(y @ y) + 1e-6
    k = range(9, 12)
    P[k, k] += 4.0 * float(y @ y) + 1e-6
    return P


def _frame_accepted(belief: Belief, x: np.ndarray, P: np.ndarray, scene: Scene) -> Belief:
    frames = (*belief.frames, True)[-scene.config.loss.window :]
    return replace(belief, x=x, P=P, frames=frames, camera_t=belief.t)


def _frame_refused(belief: Belief, scene: Scene) -> Belief:
    loss = scene.config.loss
    frames = (*belief.frames, False)[-loss.window :]
    lost = len(frames) == loss.window and frames.count(False) > loss.most_rejected * loss.window
    return replace(belief, frames=frames, is_lost=belief.is_lost or lost)


@lru_cache(maxsize=64)
def _gate(probability: float, dof: int) -> float:
    return float(chi2.ppf(probability, dof))
