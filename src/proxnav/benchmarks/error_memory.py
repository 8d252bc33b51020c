"""What a detector's errors along a flight are made of: an error of the whole pose, of each point, new or lasting.

Model, in units of the claimed covariance Sigma of each keypoint and C = (J^T Sigma^-1 J)^-1 of the least-squares pose:
error = J C^(1/2) sqrt(pose_share) xi(t) + Sigma^(1/2) (sqrt(point_share) eta(t) + sqrt(white_share) noise), where xi
and eta are first-order Gauss-Markov with the time constant tau.

Poses that something else than least squares made of the keypoints have shares of their own, of the covariance that they
claim: error = C^(1/2) (sqrt(lasting_share) xi(t) + sqrt(white_share) noise).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from jaxtyping import Float
from scipy.optimize import least_squares
from scipy.stats import chi2

from proxnav.geometry.perturbation import ROTATION, TRANSLATION

LAGS_S = (0.5, 1.5, 3.5, 6.0, 12.0, 20.0, 30.0, 45.0, 60.0, 90.0, 130.0, 180.0, 250.0, 350.0, 500.0, 700.0)
"""Edges of the bins of time between two frames."""
_POSE_DOF = 6
_WRONG = float(chi2.ppf(0.9999, _POSE_DOF))


@dataclass(frozen=True, slots=True, eq=False)
class KeypointResiduals:
    """One frame's keypoints, measured less true."""

    t: float
    range_m: float
    errors_px: Float[np.ndarray, "k 2"]
    covariances_px2: Float[np.ndarray, "k 2 2"]
    """Covariances that the detector claims."""
    jacobian: Float[np.ndarray, "k 2 6"]
    """Pixels by (dt, dr) of the pose in camera axes, at the truth."""


@dataclass(frozen=True, slots=True, eq=False)
class PoseResidual:
    """One frame's pose, measured less true: (dt [m] in camera axes, dr [rad] in target axes)."""

    t: float
    range_m: float
    error: Float[np.ndarray, "6"]
    covariance: Float[np.ndarray, "6 6"]
    """Covariance that the estimator claims."""
    equivalent_px: float
    """Keypoints with this deviation each would leave a pose covariance of the same volume."""
    keypoint_error: Float[np.ndarray, "6"]
    """Error of the least-squares pose of the same frame's keypoints."""
    keypoint_covariance: Float[np.ndarray, "6 6"]


def pose_memory(frames: Sequence[PoseResidual], fx: float) -> dict[str, Any]:
    """Shares and time constant of poses, as `error_memory` of keypoints; wrong poses are counted and left out."""
    whole = np.array([_whitened(frame.error, frame.covariance) for frame in frames])
    right = np.flatnonzero(np.sum(whole**2, axis=1) <= _WRONG).tolist()
    t, r = np.array([frames[i].t for i in right]), np.array([frames[i].range_m for i in right])
    variance, curve = float(np.mean(whole[right] ** 2)), _correlations(t, whole[right])
    tau, (keep,) = _fit(curve)
    error = np.array([frames[i].error for i in right])
    sigma_px, sigma_m = _claims(np.array([frames[i].equivalent_px for i in right]), r, fx)
    return {
        "frames": len(frames), "wrong_frames": len(frames) - len(right),
        "lasting_share": variance * keep, "white_share": variance * (1.0 - keep), "tau_s": tau,
        "variance_of_claimed": variance, "median_over_frames": float(np.median(np.mean(whole[right] ** 2, axis=1))),
        "variance_of_claimed_by_axis": np.mean(whole[right] ** 2, axis=0).tolist(),
        "claimed_sigma_px": sigma_px, "claimed_sigma_m": sigma_m,
        "rms_position_m": _rms_norm(error[:, TRANSLATION]),
        "rms_position_share_of_range": _rms_norm(error[:, TRANSLATION] / r[:, None]),
        "rms_attitude_deg": float(np.rad2deg(_rms_norm(error[:, ROTATION]))), "correlation_of_errors": curve,
        **_beside_keypoints([frames[i] for i in right]),
    }  # fmt: skip


def _beside_keypoints(frames: Sequence[PoseResidual]) -> dict[str, float]:
    """How much finer poses are than those of the keypoints, and what their errors have in common.

    With a correlation above the root of the ratio the keypoint poses hold nothing that would make the others better.
    """
    a = np.array([_whitened(frame.keypoint_error, frame.keypoint_covariance) for frame in frames])
    b = np.array([_whitened(frame.error, frame.keypoint_covariance) for frame in frames])
    right = np.sum(a**2, axis=1) <= _WRONG
    a, b = a[right], b[right]
    return {
        "variance_over_that_of_keypoint_poses": float(np.mean(b**2) / np.mean(a**2)),
        "correlation_with_keypoint_poses": float(np.sum(a * b) / np.sqrt(np.sum(a**2) * np.sum(b**2))),
    }


def _whitened(error: Float[np.ndarray, "6"], covariance: Float[np.ndarray, "6 6"]) -> Float[np.ndarray, "6"]:
    """The error in units of its claimed deviation."""
    return np.linalg.cholesky(np.linalg.inv(covariance)).T @ error


def _rms_norm(rows: Float[np.ndarray, "n 3"]) -> float:
    return float(np.sqrt(np.mean(np.sum(rows**2, axis=1))))


def error_memory(frames: Sequence[KeypointResiduals], fx: float) -> dict[str, Any]:
    """Shares, time constant, claimed deviation by range, and the correlations that they were fitted to.

    Frames whose pose is off by more than one honest frame in 10 000 would be are counted and left out: they are for the
    gates.
    """
    parts = [_split(frame) for frame in frames]
    right = [i for i, (pose, _) in enumerate(parts) if pose @ pose <= _WRONG]
    t = np.array([frames[i].t for i in right])
    pose, points = np.array([parts[i][0] for i in right]), np.array([parts[i][1] for i in right])
    dof = points[0].size - _POSE_DOF
    own = float(np.mean(np.sum(points**2, axis=(1, 2))) / dof)
    whole = float(np.mean(pose**2))
    by_pose, by_point = _correlations(t, pose), _correlations(t, points.reshape(len(t), -1))
    tau, keeps = _fit(by_pose, by_point)
    claimed = np.sqrt([np.median(frames[i].covariances_px2[:, [0, 1], [0, 1]]) for i in right])
    sigma_px, sigma_m = _claims(claimed, np.array([frames[i].range_m for i in right]), fx)
    return {
        "frames": len(frames), "wrong_frames": len(frames) - len(right),
        "pose_share": max(whole - own, 0.0), "point_share": own * keeps[1], "white_share": own * (1.0 - keeps[1]),
        "tau_s": tau, "lasting_part_of_pose_errors": keeps[0], "lasting_part_of_point_errors": keeps[1],
        "pose_variance_of_claimed": whole, "point_variance_of_claimed": own,
        "claimed_sigma_px": sigma_px, "claimed_sigma_m": sigma_m,
        "range_m": [min(f.range_m for f in frames), max(f.range_m for f in frames)],
        "correlation_of_pose_errors": by_pose, "correlation_of_point_errors": by_point,
    }  # fmt: skip


def least_squares_pose(frame: KeypointResiduals) -> tuple[Float[np.ndarray, "6"], Float[np.ndarray, "6 6"]]:
    """(error (dt, dr) in camera axes, information) of the weighted least-squares pose of a frame's keypoints."""
    W, J = np.linalg.inv(frame.covariances_px2), frame.jacobian
    H = np.einsum("kai,kab,kbj->ij", J, W, J)
    return np.linalg.solve(H, np.einsum("kai,kab,kb->i", J, W, frame.errors_px)), H


def _split(frame: KeypointResiduals) -> tuple[Float[np.ndarray, "6"], Float[np.ndarray, "k 2"]]:
    """(pose part in units of its claimed deviation, what no pose explains in units of the claimed one)."""
    step, H = least_squares_pose(frame)
    left = frame.errors_px - np.einsum("kai,i->ka", frame.jacobian, step)
    whitened = np.einsum("kba,kb->ka", np.linalg.cholesky(np.linalg.inv(frame.covariances_px2)), left)
    return np.linalg.cholesky(H).T @ step, whitened


def _correlations(t: Float[np.ndarray, "n"], values: Float[np.ndarray, "n m"]) -> list[tuple[float, float, int]]:
    """(mean time apart [s], correlation, pairs) by bins of `LAGS_S`; each bin is judged by its own variance."""
    i, j = np.triu_indices(len(t), 1)
    apart, out = np.abs(t[j] - t[i]), []
    for low, high in pairwise(LAGS_S):
        k = (apart >= low) & (apart < high)
        if k.sum() >= 20:
            a, b = values[i[k]], values[j[k]]
            out.append(
                (float(apart[k].mean()), float(np.sum(a * b) / np.sqrt(np.sum(a * a) * np.sum(b * b))), int(k.sum()))
            )
    return out


def _fit(*curves: list[tuple[float, float, int]]) -> tuple[float, list[float]]:
    """(tau, part that lasts by curve): keep * exp(-lag / tau) through all of them."""
    lags, found = [np.array(c)[:, 0] for c in curves], [np.array(c)[:, 1] for c in curves]

    def residuals(x: Float[np.ndarray, "n_parameters"]) -> Float[np.ndarray, "n_residuals"]:
        pairs = zip(x[1:], lags, found, strict=True)
        return np.concatenate([keep * np.exp(-lag / np.exp(x[0])) - value for keep, lag, value in pairs])

    n = len(curves)
    best = least_squares(residuals, [np.log(100.0), *[0.8] * n], bounds=([0.0] * (n + 1), [np.log(1e4), *[0.999] * n]))
    return float(np.exp(best.x[0])), best.x[1:].tolist()


def _claims(sigma_px: Float[np.ndarray, "n"], range_m: Float[np.ndarray, "n"], fx: float) -> tuple[float, float]:
    """(px, m) with claimed variance = px^2 + (m fx / range)^2, by least squares."""
    near = (fx / range_m) ** 2
    found = least_squares(
        lambda x: np.log(x[0] ** 2 + x[1] ** 2 * near) - 2.0 * np.log(sigma_px),
        [2.0, 0.1],
        bounds=([1e-3, 1e-4], [1e3, 1e2]),
    )
    return float(found.x[0]), float(found.x[1])
