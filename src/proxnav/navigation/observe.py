"""Measurements into the belief: gates first, then Joseph-form updates. Each gives the new belief and a verdict."""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal

import numpy as np
from scipy.stats import chi2

from proxnav.geometry.compiled.rotations import conjugate, exp, log, multiply, skew, to_matrix
from proxnav.navigation.belief import Belief, Scene
from proxnav.navigation.kernels.prediction import corrected
from proxnav.navigation.kernels.update import (
    ACCEPTED,
    gnss_model,
    joseph,
    keypoint_model,
    keypoint_update,
    pose_covariance,
    reset,
)
from proxnav.navigation.layout import FIXED

_STAR = np.array([6, 7, 8])
_POSE = np.array([0, 1, 2, 6, 7, 8, 9, 10, 11, *range(FIXED, FIXED + 6)])
_GNSS = np.array([*range(18), *range(21, 24)])
"""Errors that each measurement sees."""
_NO_RATE = np.zeros(3)

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
    index = _found(pixels, cov)
    if belief.x is None or belief.P is None:
        return belief, Verdict("not_started")
    if len(index) == 0:
        return belief, Verdict("no_points")
    config = scene.config
    belief = lasting_of_keypoints(belief, pixels, cov, scene)
    x, P, outcome, used, nis, C = keypoint_update(
        belief.x, belief.P, pixels, cov, scene.points_m, index, scene.orbit(belief.t)[2], scene.lens,
        scene.shares, _gate(config.gates.keypoint, 2), scene.frame_gates, config.gates.least_share,
    )  # fmt: skip
    if outcome != ACCEPTED:
        return _frame_refused(belief, scene), Verdict("gated", float(nis))
    count = int(used.sum())
    belief = replace(belief, pose_errors=scene.lasting_pose_share * C)
    return _frame_accepted(belief, x, P, scene), Verdict("accepted", float(nis), 2 * count, len(index) - count)


def lasting_of_keypoints(belief: Belief, pixels: np.ndarray, cov: np.ndarray, scene: Scene) -> Belief:
    """`redrawn` in the size of these keypoints' pose, where no frame just before has told it."""
    index = _found(pixels, cov)
    if len(index) == 0 or (belief.pose_errors.any() and not _has_coasted(belief, scene)):
        return belief
    assert belief.x is not None
    _, H = keypoint_model(belief.x, scene.points_m, index, scene.orbit(belief.t)[2], scene.lens)
    return redrawn(belief, pose_covariance(H, cov[index], np.linalg.norm(belief.x[:3])), scene)


def lasting_of_pose(belief: Belief, C: np.ndarray, scene: Scene) -> Belief:
    """`redrawn` after a time without frames."""
    return redrawn(belief, C, scene) if _has_coasted(belief, scene) else belief


def redrawn(belief: Belief, C: np.ndarray, scene: Scene) -> Belief:
    """What the lasting pose error forgot since the last frame comes anew in the size of this view, not of that one.

    C (6, 6): claimed covariance of the pose in this view, dr in target axes.
    """
    assert belief.P is not None
    errors, P = scene.lasting_pose_share * C, belief.P.copy()
    keep = np.exp(-(belief.t - belief.camera_t) / scene.lasting_tau_s)
    P[-6:, -6:] += (1.0 - keep**2) * (errors - belief.pose_errors) if belief.pose_errors.any() else errors
    return replace(belief, P=P, pose_errors=errors)


def _found(pixels: np.ndarray, cov: np.ndarray) -> np.ndarray:
    return np.flatnonzero(np.isfinite(pixels[:, 0]) & np.isfinite(cov[:, 0, 0]))


def _has_coasted(belief: Belief, scene: Scene) -> bool:
    return belief.t - belief.camera_t > scene.config.loss.coast_after_s


def take_pose(
    belief: Belief, q_cam_target: np.ndarray, t_m: np.ndarray, cov: np.ndarray, scene: Scene
) -> tuple[Belief, Verdict]:
    """A pose of the pose solver with its covariance (dt, dr) in camera axes; part of it lasts from frame to frame."""
    if belief.x is None or belief.P is None:
        return belief, Verdict("not_started")
    x, C = belief.x, in_target_axes(cov, q_cam_target)
    belief = lasting_of_pose(belief, C, scene)
    H, t_hat, q_hat = pose_model(x, scene.orbit(belief.t)[2])
    y = np.concatenate([t_m - t_hat, log(multiply(conjugate(q_hat), q_cam_target))])
    assert belief.P is not None
    e, P, nis = joseph(belief.P, _POSE, H, scene.config.noise.poses.white_share * C, y)
    if not nis <= _gate(scene.config.gates.frame, 6):
        return _frame_refused(belief, scene), Verdict("gated", float(nis))
    belief = replace(belief, pose_errors=scene.lasting_pose_share * C)
    return _frame_accepted(belief, corrected(x, e), reset(P, e), scene), Verdict("accepted", float(nis), 6)


def take_star_fix(belief: Belief, t: float, q: np.ndarray, sigma: np.ndarray, scene: Scene) -> tuple[Belief, Verdict]:
    """Attitude of the camera; a row of refusals says that the gyro is not what it was: its bias starts anew."""
    belief = replace(belief, fix=(t, q))
    if belief.x is None or belief.P is None:
        return belief, Verdict("not_started")
    y = log(multiply(conjugate(belief.x[6:10]), q))
    e, P, nis = joseph(belief.P, _STAR, np.eye(3), np.diag(sigma**2), y)
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
    _, _, R_eci_ric, rate = scene.orbit(belief.t)
    rate_cam = belief.rate_cam if scene.has_gyro else _NO_RATE
    H, h = gnss_model(belief.x, R_eci_ric, rate, rate_cam, scene.own_antenna, scene.other_antenna)
    R = np.diag(np.repeat(np.square(sigmas), 3))
    e, P, nis = joseph(belief.P, _GNSS, H, R, np.concatenate([position, velocity]) - h)
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


def pose_model(x: np.ndarray, R_eci_ric: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(H of (dt in camera, dr in target axes) on r, both attitudes, lasting pose error; predicted t and q)."""
    R_cam_ric = to_matrix(x[6:10]).T @ R_eci_ric
    t = -R_cam_ric @ x[:3]
    H = np.zeros((6, 15))
    H[:3, :3], H[:3, 3:6], H[3:, 6:9], H[:, 9:] = -R_cam_ric, skew(t), np.eye(3), np.eye(6)
    return H, t + x[-6:-3], multiply(x[10:14], exp(x[-3:]))


def in_target_axes(cov: np.ndarray, q_cam_target: np.ndarray) -> np.ndarray:
    """Covariance of (dt, dr) in camera axes, with dr in target axes instead."""
    A = np.eye(6)
    A[3:, 3:] = to_matrix(q_cam_target).T
    return A @ cov @ A.T


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
