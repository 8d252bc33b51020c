"""What the estimator says of each frame: keypoints and a finer pose, each with errors of its own that last."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float, Int

from proxnav.errors import InputError
from proxnav.flight.sensors.gauss_markov import gauss_markov
from proxnav.flight.truth import Truth
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.calibration import pose_moves
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.geometry.pose_jacobian import pose_jacobians_target_axes
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import KeypointData, PoseData
from proxnav.records.error_model import KeypointErrorModel, PoseErrorModel
from proxnav.targets.target import Target

CameraErrors = Float[np.ndarray, "calibration=3"]
"""Errors of the camera's calibration in this flight, in their own standard deviations."""
_LATENCY_S = (0.3, 0.6)
"""Least and most, uniform: network, pose solver and alignment on a small computer."""
_LEAST_POINTS = 4
"""Frames with fewer keypoints in the image are not reported: they give no pose."""


@dataclass(frozen=True)
class DetectorConfig:
    """Error statistics of the shipped estimator, as `proxnav benchmark detector` measures them."""

    rate_hz: float = 1.0
    sigma_px: float = 2.9
    """Claimed per axis and keypoint, with..."""
    sigma_m: float = 0.13
    """... this much on the target in view."""
    errors: KeypointErrorModel = field(default_factory=KeypointErrorModel)
    """What of the claimed covariance is really there, and how long it lasts."""
    pose_sigma_px: float = 0.68
    """The pose claims as much as keypoints with this deviation would leave, ..."""
    pose_sigma_m: float = 0.025
    """... and this much on the target."""
    pose_errors: PoseErrorModel = field(default_factory=PoseErrorModel)
    """What of the pose's claimed covariance is really there, and how long it lasts."""

    def __post_init__(self) -> None:
        for px, m in ((self.sigma_px, self.sigma_m), (self.pose_sigma_px, self.pose_sigma_m)):
            if min(px, m) < 0.0 or not px + m > 0.0:
                raise InputError("detector: the sigmas in px and m must not be negative, and one of each two positive")


@dataclass(frozen=True, slots=True, eq=False)
class _Sightings:
    """The target as n frames see it. Keypoints behind its own body are seen: the shipped detector reports them."""

    q: Float[np.ndarray, "n wxyz=4"]
    """q_cam_target."""
    t_m: Float[np.ndarray, "n 3"]
    """The target's origin in the camera frame."""
    pixels: Float[np.ndarray, "n n_keypoints 2"]
    """NaN outside the image."""
    J: Float[np.ndarray, "n n_keypoints 2 6"]
    """Pixels by (dt in camera axes, dr in target axes); zero outside the image."""

    @property
    def range_m(self) -> Float[np.ndarray, "n"]:
        """Distance from the camera."""
        return np.linalg.norm(self.t_m, axis=1)


def read_keypoints(
    truth: Truth, target: Target, camera: Camera, config: DetectorConfig, rng: np.random.Generator,
    errors_of_camera: CameraErrors,
) -> KeypointData:  # fmt: skip
    """Keypoints at the camera's rate, each with the covariance that the detector claims."""
    k = truth.every(config.rate_hz)
    dt = truth.step_s * float(k[1] - k[0]) if len(k) > 1 else 1.0
    sight, errors, n = _sightings(truth, k, target, camera), config.errors, len(k)
    sigma = np.hypot(config.sigma_px, config.sigma_m * camera.fx / sight.range_m)
    seen = np.isfinite(sight.pixels[..., 0])
    displaced = _lasting(truth.t[k], np.sqrt(errors.pose_share) * _pose_roots(sight, sigma), errors.tau_s, rng)
    q = quaternion.multiply(sight.q, quaternion.exp(displaced[:, ROTATION]))
    apparent = camera.erring(errors_of_camera).project(_in_camera(q, sight.t_m + displaced[:, TRANSLATION], target))
    own = gauss_markov(np.sqrt(errors.point_share), errors.tau_s, dt, sight.pixels.shape, rng)
    own = own + np.sqrt(errors.white_share) * rng.normal(size=sight.pixels.shape)
    pixels = np.where(seen[..., None], apparent + sigma[:, None, None] * own, np.nan)
    received = truth.t[k] + rng.uniform(*_LATENCY_S, size=n)
    cov = np.where(seen[..., None, None], np.square(sigma)[:, None, None, None] * np.eye(2), np.nan)
    keep = seen.sum(axis=1) >= _LEAST_POINTS
    order = np.argsort(received[keep])
    return KeypointData(*(column[keep][order] for column in (truth.t[k], received, pixels, cov)))


def read_poses(
    truth: Truth,
    keypoints: KeypointData,
    target: Target,
    camera: Camera,
    config: DetectorConfig,
    rng: np.random.Generator,
    errors_of_camera: CameraErrors,
) -> PoseData:
    """The pose of each frame of keypoints, with a lasting and a new part of the covariance that it claims."""
    order = np.argsort(keypoints.t)
    t, errors = keypoints.t[order], config.pose_errors
    k = np.round((t - truth.t[0]) / truth.step_s).astype(int)
    sight = _sightings(truth, k, target, camera)
    roots = _pose_roots(sight, np.hypot(config.pose_sigma_px, config.pose_sigma_m * camera.fx / sight.range_m))
    off = _lasting(t, np.sqrt(errors.lasting_share) * roots, errors.tau_s, rng)
    off = off + np.sqrt(errors.white_share) * np.einsum("nij,nj->ni", roots, rng.normal(size=off.shape))
    if not camera.calibration_sigma.is_exact:
        moves = _calibration_moves(sight, camera)
        off, roots = off - moves @ errors_of_camera, np.concatenate([roots, moves], axis=-1)
    q = quaternion.normalize(quaternion.multiply(sight.q, quaternion.exp(off[:, ROTATION])))
    A = np.tile(np.eye(6), (len(t), 1, 1))
    A[:, ROTATION, ROTATION] = quaternion.to_matrix(q)
    C = A @ roots @ np.swapaxes(A @ roots, -1, -2)
    back = np.argsort(order)
    t_m = sight.t_m + off[:, TRANSLATION]
    return PoseData(keypoints.t, keypoints.received, q[back], t_m[back], C[back])


def _sightings(truth: Truth, k: Int[np.ndarray, "n"], target: Target, camera: Camera) -> _Sightings:
    q, t_m = truth.q_cam_target[k], truth.t_cam_target_m[k]
    pixels = camera.project(_in_camera(q, t_m, target))
    pixels[~camera.contains(pixels)] = np.nan
    J = pose_jacobians_target_axes(q, t_m, target.keypoints_m, camera)
    return _Sightings(q, t_m, pixels, np.where(np.isnan(pixels)[..., None], 0.0, J))


def _in_camera(q: QuatWxyz, t_m: Vector3, target: Target) -> Float[np.ndarray, "n n_keypoints 3"]:
    """Keypoints in the camera frame [m]."""
    return quaternion.rotate(q[:, None], target.keypoints_m[None]) + t_m[:, None]


def _lasting(
    t: Float[np.ndarray, "n"], roots: Float[np.ndarray, "n 6 6"], tau_s: float, rng: np.random.Generator
) -> Float[np.ndarray, "n 6"]:
    """By how much the whole target is seen displaced: Gauss-Markov, driven by what such views allow."""
    out = np.einsum("nij,nj->ni", roots, rng.normal(size=(len(t), 6)))
    keep = np.exp(-np.diff(t) / tau_s)
    for i in range(1, len(out)):
        out[i] = keep[i - 1] * out[i - 1] + np.sqrt(1.0 - keep[i - 1] ** 2) * out[i]
    return out


def _calibration_moves(sight: _Sightings, camera: Camera) -> Float[np.ndarray, "n 6 calibration=3"]:
    """Movement of each pose by one standard deviation of each error of the calibration."""
    C = camera.calibration_sigma.moves(np.nan_to_num(sight.pixels - (camera.cx, camera.cy)))
    return pose_moves(sight.J, np.broadcast_to(np.eye(2), (*sight.J.shape[:2], 2, 2)), C)


def _pose_roots(sight: _Sightings, sigma: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 6 6"]:
    """Lower roots of the covariances of least-squares poses; frames of too few points get a wide one."""
    H = np.einsum("nkai,nkaj->nij", sight.J, sight.J) / np.square(sigma)[:, None, None]
    wide = np.full((len(H), 6), 4.0)
    wide[:, TRANSLATION] = 1.0 / (0.3 * sight.range_m[:, None]) ** 2
    return np.linalg.cholesky(np.linalg.inv(H + wide[:, :, None] * np.eye(6)))
