"""Measurements into a belief: gates first, then Joseph-form updates. Each gives the new belief and a verdict."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from jaxtyping import Float, Int

from proxnav.geometry.calibration import CalibrationSigma, pose_moves
from proxnav.geometry.compiled.rotations import conjugate, exp, log, multiply, to_matrix
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.geometry.pose_jacobian import pose_jacobians_target_axes
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.navigation.belief import Tracking, turning
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.gates import GNSS_GATE, POINT_GATE, POSE_GATE, STAR_GATE
from proxnav.navigation.kernels.error_state import corrected, reset
from proxnav.navigation.kernels.gnss import gnss_model
from proxnav.navigation.kernels.joseph import joseph
from proxnav.navigation.kernels.keypoints import keypoint_model, keypoint_update, pose_covariance
from proxnav.navigation.kernels.seen_pose import seen_pose
from proxnav.navigation.layout import (
    FRAME,
    N_POSE,
    SEEN_BY_GNSS,
    SEEN_BY_STAR_TRACKER,
    Covariance,
    E,
    PoseCovariance,
    StateVector,
    X,
    diagonal,
)
from proxnav.navigation.learnt_noise import lasting_share, memory_s, resized, taught_by_pose, white_share
from proxnav.navigation.readings import GnssFix, KeypointFrame, PoseFix, StarFix

_WINDOW = 16
"""So many last frames are judged together..."""
_MOST_REFUSED = 0.7
"""... and with more than this share of them refused the filter is lost: the next pose starts it again."""
_STREAK = 8
"""So many refused fixes in a row and the filter gives the fix its way: attitude, gyro bias or GNSS bias restart."""
_MOST_CALIBRATION = 0.99
"""Share of a pose's variance in any direction that may be the calibration's."""

Outcome = Literal[
    "accepted", "gated", "no_points", "not_started", "started", "late", "duplicate", "ahead", "invalid", "unused"
]  # fmt: skip
"""invalid: taken where the ephemeris does not reach; unused: keypoints where poses are measured instead."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """What became of a measurement."""

    outcome: Outcome
    nis: float = float("nan")
    """Normalised innovation squared, `dof` on average when the filter is honest."""
    dof: int = 0
    gated_points: int = 0
    """Keypoints of an accepted frame that were refused by themselves."""


def take_keypoints(belief: Tracking, frame: KeypointFrame, setup: FilterSetup) -> tuple[Tracking, Verdict]:
    """A frame of keypoints, each measured by itself."""
    index = _found(frame)
    if len(index) == 0:
        return belief, Verdict("no_points")
    belief = lasting_of_keypoints(belief, frame, setup)
    x, P, is_accepted, used, nis, C = keypoint_update(
        belief.x, belief.P, frame.pixels, frame.covariances_px2, setup.points_m, index, turning(belief, setup),
        setup.lens, setup.shares, POINT_GATE, setup.frame_gates,
    )  # fmt: skip
    if not is_accepted:
        return _frame_refused(belief), Verdict("gated", float(nis))
    count = int(used.sum())
    belief = replace(belief, pose_errors=setup.lasting_pose_share * C)
    return _frame_accepted(belief, x, P), Verdict("accepted", float(nis), 2 * count, len(index) - count)


def take_pose(belief: Tracking, fix: PoseFix, setup: FilterSetup) -> tuple[Tracking, Verdict]:
    """A pose of the pose solver; part of its error lasts from frame to frame."""
    x, C = belief.x, noise_of_pose(fix, setup)
    belief = lasting_of_pose(belief, C, setup)
    H, t_hat, q_hat = seen_pose(x, *turning(belief, setup))
    if setup.layout.n_calibration:
        S = -calibration_moves(fix, setup, setup.real_camera.calibration_sigma)  # the state is true minus assumed
        off, H = S @ x[X.calibration], np.concatenate([H, S], axis=1)
        t_hat, q_hat = t_hat + off[TRANSLATION], multiply(q_hat, exp(off[ROTATION]))
    y = np.concatenate([fix.t_cam_target_m - t_hat, log(multiply(conjugate(q_hat), fix.q_cam_target))])
    before, seen = belief.memory, setup.layout.seen_by_pose
    unsure = _unsure_of_clock(belief, H)
    belief = taught_by_pose(belief, y, C, H @ belief.P[np.ix_(seen, seen)] @ H.T + unsure, setup)
    e, P, nis = joseph(belief.P, seen, H, white_share(belief.memory, setup) * C + unsure, y)
    if not nis <= POSE_GATE:
        return resized(_frame_refused(belief), before, setup), Verdict("gated", float(nis))
    belief = replace(belief, pose_errors=lasting_share(belief.memory, setup) * C)
    belief = _frame_accepted(belief, corrected(x, e), reset(P, e))
    return resized(belief, before, setup), Verdict("accepted", float(nis), N_POSE)


def _unsure_of_clock(belief: Tracking, H: Float[np.ndarray, "6 n_columns"]) -> PoseCovariance:
    """What the clock's error and those of velocity and rate do together: a term of second order, large at the start."""
    late = float(belief.P[E.clock, E.clock][0, 0])
    R = np.zeros((N_POSE, N_POSE))
    to_camera = H[TRANSLATION, FRAME.position]
    R[TRANSLATION, TRANSLATION] = late * to_camera @ belief.P[E.velocity, E.velocity] @ to_camera.T
    R[ROTATION, ROTATION] = late * belief.P[E.rate, E.rate]
    return R


def take_star_fix(belief: Tracking, fix: StarFix, setup: FilterSetup) -> tuple[Tracking, Verdict]:
    """Attitude of the camera; a row of refusals says that the gyro is not what it was: its bias starts anew."""
    y = log(multiply(conjugate(belief.x[X.q_eci_cam]), fix.q_eci_cam))
    e, P, nis = joseph(belief.P, SEEN_BY_STAR_TRACKER, np.eye(3), np.diag(fix.sigma_rad**2), y)
    if nis <= STAR_GATE:
        belief = replace(belief, x=corrected(belief.x, e), P=reset(P, e), star_streak=0)
        return belief, Verdict("accepted", float(nis), len(y))
    belief = replace(belief, star_streak=belief.star_streak + 1)
    if belief.star_streak >= _STREAK:
        belief = replace(belief, P=_loosened_gyro(belief.P, setup, y), star_streak=0)
    return belief, Verdict("gated", float(nis))


def take_gnss(belief: Tracking, fix: GnssFix, setup: FilterSetup) -> tuple[Tracking, Verdict]:
    """Baseline between the antennas and its rate. A row of refusals: the GNSS bias starts anew."""
    H, h = gnss_model(belief.x, *turning(belief, setup), *setup.arms_m)
    y = np.concatenate([fix.position_m, fix.velocity_mps]) - h
    R = np.diag(np.repeat(np.square((fix.sigma_position_m, fix.sigma_velocity_mps)), 3))
    e, P, nis = joseph(belief.P, SEEN_BY_GNSS, H, R, y)
    if nis <= GNSS_GATE:
        belief = replace(belief, x=corrected(belief.x, e), P=reset(P, e), gnss_streak=0)
        return belief, Verdict("accepted", float(nis), len(y))
    belief = replace(belief, gnss_streak=belief.gnss_streak + 1)
    if belief.gnss_streak >= _STREAK:
        P = decoupled(belief.P, E.gnss_bias, 10.0 * setup.config.noise.gnss_bias_m)
        belief = replace(belief, P=P, gnss_streak=0)
    return belief, Verdict("gated", float(nis))


def lasting_of_keypoints(belief: Tracking, frame: KeypointFrame, setup: FilterSetup) -> Tracking:
    """`redrawn` in the size of these keypoints' pose, where no frame just before has told it."""
    index = _found(frame)
    if len(index) == 0 or (belief.pose_errors.any() and not belief.has_coasted):
        return belief
    _, H = keypoint_model(belief.x, setup.points_m, index, turning(belief, setup), setup.lens)
    C = pose_covariance(H, frame.covariances_px2[index], np.linalg.norm(belief.x[X.position]))
    return redrawn(belief, C, setup)


def lasting_of_pose(belief: Tracking, C: PoseCovariance, setup: FilterSetup) -> Tracking:
    """`redrawn` after a time without frames."""
    return redrawn(belief, C, setup) if belief.has_coasted else belief


def redrawn(belief: Tracking, C: PoseCovariance, setup: FilterSetup) -> Tracking:
    """What the lasting pose error forgot since the last frame comes anew in the size of this view, not of that one.

    C: claimed covariance of the pose in this view, dr in target axes.
    """
    errors, P = lasting_share(belief.memory, setup) * C, belief.P.copy()
    keep = np.exp(-(belief.t - belief.camera_t) / memory_s(belief.memory, setup))
    known = belief.pose_errors
    P[E.pose_error, E.pose_error] += (1.0 - keep**2) * (errors - known) if known.any() else errors
    return replace(belief, P=P, pose_errors=errors)


def noise_of_pose(fix: PoseFix, setup: FilterSetup) -> PoseCovariance:
    """Covariance of a pose, dr in target axes, without what the camera's calibration leaves open: that is a state."""
    C = in_target_axes(fix.covariance, fix.q_cam_target)
    if setup.sigma_in_poses.is_exact:
        return C
    L = np.linalg.cholesky(C)
    U, s, _ = np.linalg.svd(np.linalg.solve(L, calibration_moves(fix, setup, setup.sigma_in_poses)))
    kept = np.ones(N_POSE)
    kept[: len(s)] -= np.minimum(np.square(s), _MOST_CALIBRATION)
    half = L @ U
    return (half * kept) @ half.T


def calibration_moves(
    fix: PoseFix, setup: FilterSetup, sigma: CalibrationSigma
) -> Float[np.ndarray, "6 calibration=3"]:
    """(dt in camera, dr in target axes) of a pose of the keypoints in view by one standard deviation of each error."""
    camera, points = setup.real_camera, setup.points_m
    q, t = fix.q_cam_target[None], fix.t_cam_target_m[None]
    pixels = camera.project(points @ to_matrix(fix.q_cam_target).T + t)
    J = pose_jacobians_target_axes(q, t, points, camera)[0]
    seen = camera.contains(pixels) & np.isfinite(J).all(axis=(1, 2))
    return pose_moves(
        J[seen], np.tile(np.eye(2), (seen.sum(), 1, 1)), sigma.moves(pixels[seen] - (camera.cx, camera.cy))
    )


def in_target_axes(cov: PoseCovariance, q_cam_target: QuatWxyz) -> PoseCovariance:
    """Covariance of (dt, dr) in camera axes, with dr in target axes instead."""
    A = np.eye(N_POSE)
    A[ROTATION, ROTATION] = to_matrix(q_cam_target).T
    return A @ cov @ A.T


def decoupled(P: Covariance, block: slice, sigma: float) -> Covariance:
    """P with the errors of one block unknown to `sigma` and independent of the others."""
    out = P.copy()
    out[block, :], out[:, block] = 0.0, 0.0
    out[diagonal(block)] = sigma**2
    return out


def _loosened_gyro(P: Covariance, setup: FilterSetup, y: Vector3) -> Covariance:
    """Attitude as wrong as the fix says, bias as unknown as at the start; the relative attitude keeps its own."""
    P = decoupled(P, E.gyro_bias, 10.0 * setup.config.noise.gyro_bias)
    P[diagonal(E.attitudes)] += 4.0 * float(y @ y) + 1e-6
    return P


def _found(frame: KeypointFrame) -> Int[np.ndarray, "n_found"]:
    """Keypoints that the frame has."""
    return np.flatnonzero(np.isfinite(frame.pixels[:, 0]) & np.isfinite(frame.covariances_px2[:, 0, 0]))


def _frame_accepted(belief: Tracking, x: StateVector, P: Covariance) -> Tracking:
    return replace(belief, x=x, P=P, frames=(*belief.frames, True)[-_WINDOW:], camera_t=belief.t)


def _frame_refused(belief: Tracking) -> Tracking:
    frames = (*belief.frames, False)[-_WINDOW:]
    lost = len(frames) == _WINDOW and frames.count(False) > _MOST_REFUSED * _WINDOW
    return replace(belief, frames=frames, is_lost=belief.is_lost or lost)
