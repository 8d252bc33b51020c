"""What the detector and the pose solver say of each frame: keypoints with errors that last, and poses from them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.datasets.records import KeypointData, PoseData
from proxnav.geometry import Camera, Pose, quaternion, so3
from proxnav.navigation.sensors.fixes import every
from proxnav.navigation.sensors.gauss_markov import gauss_markov
from proxnav.navigation.truth import Truth
from proxnav.targets.target import Target
from proxnav.targets.visibility import visible_keypoints

_LEAST_VARIANCE = 1e-4  # px^2; a perfect detector claims a hundredth of a pixel


@dataclass(frozen=True)
class DetectorConfig:
    """Error statistics of the keypoint detector."""

    rate_hz: float = 1.0
    white_px: float = 1.0
    """New in every frame, per axis and keypoint."""
    correlated_px: float = 1.0
    """The same view gives the same error: first-order Gauss-Markov, per axis and keypoint."""
    tau_s: float = 60.0
    """Its correlation time."""
    latency_s: tuple[float, float] = (0.3, 0.6)
    occlusion: bool = True
    """Keypoints behind the target's own body are not reported."""
    least_points: int = 4
    """Frames with fewer visible keypoints are not reported."""


def read_keypoints(
    truth: Truth, target: Target, camera: Camera, config: DetectorConfig, rng: np.random.Generator
) -> KeypointData:
    """Keypoints at the camera's rate; each comes with the covariance of both errors together."""
    k = every(truth, config.rate_hz)
    dt = truth.step_s * float(k[1] - k[0]) if len(k) > 1 else 1.0
    shape = (len(k), len(target.keypoints_m), 2)
    pixels = np.stack([_seen(truth, int(i), target, camera, config.occlusion) for i in k])
    pixels = pixels + gauss_markov(config.correlated_px, config.tau_s, dt, shape, rng)
    pixels = pixels + config.white_px * rng.normal(size=shape)
    received = truth.t[k] + rng.uniform(*config.latency_s, size=len(k))
    variance = max(config.white_px**2 + config.correlated_px**2, _LEAST_VARIANCE)
    cov = np.tile(variance * np.eye(2), (*shape[:2], 1, 1))
    cov[np.isnan(pixels[..., 0])] = np.nan
    keep = np.isfinite(pixels[..., 0]).sum(axis=1) >= config.least_points
    order = np.argsort(received[keep])
    return KeypointData(*(column[keep][order] for column in (truth.t[k], received, pixels, cov)))


def read_poses(truth: Truth, keypoints: KeypointData, target: Target, camera: Camera) -> PoseData:
    """The weighted least-squares pose of each frame's keypoints, linearised at the truth: no outliers, no ambiguity."""
    q, p = truth.q_cam_target, truth.t_cam_target_m
    rows = [round((float(t) - float(truth.t[0])) / truth.step_s) for t in keypoints.t]
    found = [
        _least_squares(Pose.from_wxyz("cam", "target", q[i], p[i]), keypoints, j, target.keypoints_m, camera)
        for j, i in enumerate(rows)
    ]
    n = len(found)
    return PoseData(
        keypoints.t,
        keypoints.received,
        np.array([pose.q_wxyz for pose, _ in found]).reshape(n, 4),
        np.array([pose.t_m for pose, _ in found]).reshape(n, 3),
        np.array([C for _, C in found]).reshape(n, 6, 6),
    )


def _seen(truth: Truth, i: int, target: Target, camera: Camera, occlusion: bool) -> Float[np.ndarray, "k 2"]:
    T = Pose.from_wxyz("cam", "target", truth.q_cam_target[i], truth.t_cam_target_m[i])
    pixels = camera.project(T @ target.keypoints_m)
    pixels[~camera.contains(pixels)] = np.nan
    if occlusion:
        pixels[~visible_keypoints(target, T)] = np.nan
    return pixels


def _least_squares(
    T: Pose, data: KeypointData, j: int, points_m: Float[np.ndarray, "k 3"], camera: Camera
) -> tuple[Pose, Float[np.ndarray, "6 6"]]:
    use = np.isfinite(data.pixels[j, :, 0])
    turned = points_m[use] @ T.R.T
    J_pi = camera.projection_jacobian(turned + T.t_m)
    J = np.concatenate([J_pi, -J_pi @ so3.skew(turned)], axis=-1)
    W = np.linalg.inv(data.covariances_px2[j, use])
    H = np.einsum("nia,nij,njb->ab", J, W, J)
    e = data.pixels[j, use] - camera.project(turned + T.t_m)
    C = np.linalg.inv(H)
    step = C @ np.einsum("nia,nij,nj->a", J, W, e)
    q = quaternion.multiply(quaternion.exp(step[3:]), T.q_wxyz)
    return Pose.from_wxyz("cam", "target", quaternion.normalize(q), T.t_m + step[:3]), 0.5 * (C + C.T)
