"""What the estimator says of each frame: keypoints and a finer pose, each with errors of its own that last."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.flight.sensors.fixes import every
from proxnav.flight.sensors.gauss_markov import gauss_markov
from proxnav.flight.truth import Truth
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.pose_jacobian import pose_jacobians_target_axes
from proxnav.records import KeypointData, PoseData
from proxnav.records.error_model import KeypointErrorModel, PoseErrorModel
from proxnav.targets.keypoints.visibility import visible_keypoints
from proxnav.targets.target import Target


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
    latency_s: tuple[float, float] = (0.3, 0.6)
    occlusion: bool = False
    """Keypoints behind the target's own body are not reported; the shipped detector reports them, as good as others."""
    least_points: int = 4
    """Frames with fewer keypoints in the image are not reported."""

    def __post_init__(self) -> None:
        for px, m in ((self.sigma_px, self.sigma_m), (self.pose_sigma_px, self.pose_sigma_m)):
            if min(px, m) < 0.0 or not px + m > 0.0:
                raise InputError("detector: the sigmas in px and m must not be negative, and one of each two positive")


@dataclass(frozen=True, slots=True, eq=False)
class _Views:
    """The target as n frames see it."""

    t_m: np.ndarray
    q: np.ndarray
    pixels: np.ndarray
    """(n, k, 2), NaN outside the image."""
    J: np.ndarray
    """(n, k, 2, 6) pixels by (dt in camera axes, dr in target axes)."""


def read_keypoints(
    truth: Truth, target: Target, camera: Camera, config: DetectorConfig, rng: np.random.Generator
) -> KeypointData:
    """Keypoints at the camera's rate, each with the covariance that the detector claims."""
    k = every(truth, config.rate_hz)
    dt = truth.step_s * float(k[1] - k[0]) if len(k) > 1 else 1.0
    views, errors, n = _views(truth.q_cam_target[k], truth.t_cam_target_m[k], target, camera), config.errors, len(k)
    sigma = np.hypot(config.sigma_px, config.sigma_m * camera.fx / np.linalg.norm(views.t_m, axis=1))
    seen = np.isfinite(views.pixels[..., 0])
    if config.occlusion:
        seen &= np.array([_unhidden(target, q, t) for q, t in zip(views.q, views.t_m, strict=True)])
    displaced = _lasting(truth.t[k], np.sqrt(errors.pose_share) * _pose_roots(views, sigma), errors.tau_s, rng)
    q = quaternion.multiply(views.q, quaternion.exp(displaced[:, 3:]))
    apparent = _views(q, views.t_m + displaced[:, :3], target, camera, cut=False)
    own = gauss_markov(np.sqrt(errors.point_share), errors.tau_s, dt, views.pixels.shape, rng)
    own = own + np.sqrt(errors.white_share) * rng.normal(size=views.pixels.shape)
    pixels = np.where(seen[..., None], apparent.pixels + sigma[:, None, None] * own, np.nan)
    received = truth.t[k] + rng.uniform(*config.latency_s, size=n)
    cov = np.where(seen[..., None, None], np.square(sigma)[:, None, None, None] * np.eye(2), np.nan)
    keep = seen.sum(axis=1) >= config.least_points
    order = np.argsort(received[keep])
    return KeypointData(*(column[keep][order] for column in (truth.t[k], received, pixels, cov)))


def read_poses(
    truth: Truth,
    keypoints: KeypointData,
    target: Target,
    camera: Camera,
    config: DetectorConfig,
    rng: np.random.Generator,
) -> PoseData:
    """The pose of each frame of keypoints, with a lasting and a new part of the covariance that it claims."""
    order = np.argsort(keypoints.t)
    t, errors = keypoints.t[order], config.pose_errors
    k = np.round((t - truth.t[0]) / truth.step_s).astype(int)
    views = _views(truth.q_cam_target[k], truth.t_cam_target_m[k], target, camera)
    distance = np.linalg.norm(views.t_m, axis=1)
    roots = _pose_roots(views, np.hypot(config.pose_sigma_px, config.pose_sigma_m * camera.fx / distance))
    off = _lasting(t, np.sqrt(errors.lasting_share) * roots, errors.tau_s, rng)
    off = off + np.sqrt(errors.white_share) * np.einsum("nij,nj->ni", roots, rng.normal(size=off.shape))
    q = quaternion.normalize(quaternion.multiply(views.q, quaternion.exp(off[:, 3:])))
    A = np.tile(np.eye(6), (len(t), 1, 1))
    A[:, 3:, 3:] = quaternion.to_matrix(q)
    C = A @ roots @ np.swapaxes(A @ roots, -1, -2)
    back = np.argsort(order)
    return PoseData(keypoints.t, keypoints.received, q[back], (views.t_m + off[:, :3])[back], C[back])


def _views(q: np.ndarray, t_m: np.ndarray, target: Target, camera: Camera, cut: bool = True) -> _Views:
    pixels = camera.project(quaternion.rotate(q[:, None], target.keypoints_m[None]) + t_m[:, None])
    if cut:
        pixels[~camera.contains(pixels)] = np.nan
    J = pose_jacobians_target_axes(q, t_m, target.keypoints_m, camera)
    return _Views(t_m, q, pixels, np.where(np.isnan(pixels)[..., None], 0.0, J))


def _unhidden(target: Target, q: np.ndarray, t_m: np.ndarray) -> np.ndarray:
    return visible_keypoints(target, Pose.from_wxyz("cam", "target", q, t_m))


def _lasting(
    t: Float[np.ndarray, "n"], roots: Float[np.ndarray, "n 6 6"], tau_s: float, rng: np.random.Generator
) -> Float[np.ndarray, "n 6"]:
    """By how much the whole target is seen displaced: Gauss-Markov, driven by what such views allow."""
    out = np.einsum("nij,nj->ni", roots, rng.normal(size=(len(t), 6)))
    keep = np.exp(-np.diff(t) / tau_s)
    for i in range(1, len(out)):
        out[i] = keep[i - 1] * out[i - 1] + np.sqrt(1.0 - keep[i - 1] ** 2) * out[i]
    return out


def _pose_roots(views: _Views, sigma: Float[np.ndarray, "n"]) -> Float[np.ndarray, "n 6 6"]:
    """Lower roots of the covariances of least-squares poses; frames of too few points get a wide one."""
    H = np.einsum("nkai,nkaj->nij", views.J, views.J) / np.square(sigma)[:, None, None]
    distance = np.linalg.norm(views.t_m, axis=1)[:, None]
    wide = np.concatenate([np.repeat(1.0 / (0.3 * distance) ** 2, 3, axis=1), np.full((len(H), 3), 4.0)], axis=1)
    return np.linalg.cholesky(np.linalg.inv(H + wide[:, :, None] * np.eye(6)))
