"""Keypoints to pose: search over three-point subsets, robust weighted refinement, covariance, and a status."""

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from proxnav.geometry import Camera, Pose
from proxnav.geometry.compiled import rotations
from proxnav.geometry.perturbation import ROTATION
from proxnav.pose.solve.chance import residual_chance
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.consensus import (
    Fit,
    agrees,
    cost_behind,
    fit_consensus,
    information,
    rms_px,
    seen_from_behind,
    turn_between,
)
from proxnav.pose.solve.intake import Correspondences, as_flags, correspondences
from proxnav.pose.solve.intrinsics import intrinsics_moves
from proxnav.pose.solve.misreadings import is_mirrored, is_normalised, is_of_a_crop
from proxnav.pose.solve.noise import fit_at_unknown_noise
from proxnav.records import PoseResult
from proxnav.records.estimates import NO_MOVES, PoseStatus

_DEFAULTS = PoseConfig()
_FAR_APART = 16.0  # squared 4 sigma: a rival closer than this is covered by the covariance
_LEAST_GAP = 4.0  # of the squared normalised errors to a rival, odds of 7 to 1: a smaller one is ambiguous
_MIRROR_MARGIN = 25.0  # squared 5 sigma
_MIRROR_RATIO = 1e-4  # a hundred times smaller residuals: exact data


def estimate_pose(
    points_target_m: ArrayLike,
    points_px: ArrayLike,
    camera: Camera,
    covariances_px2: ArrayLike | None = None,
    scores: ArrayLike | None = None,
    config: PoseConfig = _DEFAULTS,
) -> PoseResult:
    """Pose T_cam_target with covariance from points (n, 3) [m] in the target frame and (n, 2) [px] in the image.

    Points not found are NaN or have score 0. `covariances_px2` (n, 2, 2) decide inliers and weights; without them
    `config.sigma_px` is assumed, and enlarged where the points disagree more. The covariance (6, 6) is of (dt, dr) in
    the camera frame: t_true = t + dt, R_true = exp(dr) R; it holds what `camera.calibration_sigma` leaves open. Failure
    is a status, see `PoseResult`.

    >>> camera = Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
    >>> cube = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    >>> result = estimate_pose(cube, camera.project(cube + [0.5, 0.0, 20.0]), camera)
    >>> result.status, result.T_cam_target.t_m.round(6).tolist()
    ('ok', [0.5, 0.0, 20.0])
    """
    data = correspondences(points_target_m, points_px, camera, covariances_px2, scores, config)
    if data.places < config.min_inliers:
        return PoseResult.failure("too_few_points", len(data.keep))
    if is_normalised(data):
        return PoseResult.failure("other_pixels", len(data.keep))
    noise_unknown = covariances_px2 is None
    fit = fit_at_unknown_noise(data, config) if noise_unknown else fit_consensus(data, 1.0, config)
    if fit is None or not agrees(fit, data, config):
        return PoseResult.failure(_why_none(fit, data, camera, noise_unknown, config), len(data.keep))
    return _judged(fit, data, camera, noise_unknown, config)


def _why_none(
    fit: Fit | None, data: Correspondences, camera: Camera, noise_unknown: bool, config: PoseConfig
) -> PoseStatus:
    if seen_from_behind(data, config):
        return "behind_camera"
    return "mirrored_points" if is_mirrored(fit, data, camera, noise_unknown, config) else "no_consensus"


def _judged(fit: Fit, data: Correspondences, camera: Camera, noise_unknown: bool, config: PoseConfig) -> PoseResult:
    """The result, or no_consensus where the points do not determine the pose."""
    T_cam_target = Pose("cam", "target", rotations.from_matrix(fit.R), fit.t - fit.R @ data.centroid)
    moves, misfit = intrinsics_moves(fit, data, T_cam_target, camera, config)
    expected = max(2 * int(np.count_nonzero(fit.use)) - 6, 1) + misfit
    reduced = float(fit.d2(data)[fit.use].sum()) / expected
    covariance = _covariance(information(fit, data, config))
    if covariance is None or not camera.contains(data.pixels[fit.use]).any():
        return PoseResult.failure("no_consensus", len(data.keep))
    # Without given covariances the noise is what the residuals show, so exact data tell exact rivals apart.
    noise2 = min(1.0, max(reduced, 1e-9)) if noise_unknown else 1.0
    if _is_ambiguous(fit, covariance, _LEAST_GAP * noise2):
        return PoseResult.failure("no_consensus", len(data.keep))
    if _belongs_behind(fit, data, config):
        return PoseResult.failure("behind_camera", len(data.keep))
    if is_mirrored(fit, data, camera, noise_unknown, config):
        return PoseResult.failure("mirrored_points", len(data.keep))
    if is_of_a_crop(fit, data, T_cam_target, camera):
        return PoseResult.failure("other_pixels", len(data.keep))
    if config.inflation == "residual":
        covariance = covariance * max(1.0, reduced)
    inliers = as_flags(len(data.keep), np.flatnonzero(data.keep)[fit.use])
    if moves is not NO_MOVES:
        covariance = covariance + moves @ moves.T
    p_value = residual_chance(fit.d2(data), fit.use, noise_unknown)
    return PoseResult("ok", T_cam_target, covariance, inliers, rms_px(fit, data), moves, p_value)


def _belongs_behind(fit: Fit, data: Correspondences, config: PoseConfig) -> bool:
    """Whether the mirrored pose behind the camera fits far better, as after a sign error in the pixels.

    From far away the two differ by less than the noise, so chance must not decide.
    """
    behind = cost_behind(fit, data, config)
    return behind + _MIRROR_MARGIN < fit.cost or behind < _MIRROR_RATIO * fit.cost


def _covariance(H: Float[np.ndarray, "6 6"]) -> Float[np.ndarray, "6 6"] | None:
    """Inverse of the information, scaled to unit diagonal first; None where it is singular."""
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(H), 1e-300))
    scaled = H * scale * scale[:, None]
    try:
        L = np.linalg.cholesky(scaled)
    except np.linalg.LinAlgError:
        return None
    if L.diagonal().min() < 1e-6:
        return None
    half = np.linalg.inv(L) * scale  # H^-1 = half^T half
    return half.T @ half


def _is_ambiguous(fit: Fit, covariance: Float[np.ndarray, "6 6"], least_gap: float) -> bool:
    """Whether a pose outside the covariance fits the points nearly as well."""
    if not fit.rival_cost - fit.cost < least_gap:
        return False
    dr = turn_between(fit.R, fit.rival_R)
    return bool(dr @ np.linalg.solve(covariance[ROTATION, ROTATION], dr) > _FAR_APART)
