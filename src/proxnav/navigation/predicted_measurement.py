"""What the detector may expect in the next frame: where the target is, how it is turned, and how sure that is."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose, so3
from proxnav.geometry.types import Box, Pixels, Points
from proxnav.navigation.layout import PoseCovariance
from proxnav.records import NavState

_SIGMAS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class PredictedMeasurement:
    """Pose, keypoints and box of the target as the filter expects them in a frame."""

    T_cam_target: Pose
    covariance: PoseCovariance
    """Covariance of (dt [m], dr [rad]) in camera axes, as PoseResult has it."""
    keypoints_px: Pixels
    """NaN behind the camera."""
    keypoint_sigma_px: Float[np.ndarray, "n_keypoints"]
    """Largest standard deviation of each predicted keypoint."""
    box_xyxy: Box
    """Holds the given points with three standard deviations around them, cut at the image [px]; NaN when outside."""


def predict_measurement(state: NavState, points_m: Points, camera: Camera) -> PredictedMeasurement:
    """Expectation for a frame at the time of `state`; `points_m`: keypoints, or the mesh's vertices for a full box."""
    T = Pose.from_wxyz("cam", "target", state.q_cam_target, state.t_cam_target_m)
    cam = T @ points_m
    pixels = camera.project(cam)
    front = np.isfinite(pixels[:, 0])
    turned = points_m[front] @ T.R.T
    J_pi = camera.projection_jacobian(cam[front])
    J = np.concatenate([J_pi, -J_pi @ so3.skew(turned)], axis=-1)
    C = J @ state.pose_covariance @ np.swapaxes(J, -1, -2)
    sigma = np.full(len(points_m), np.nan)
    sigma[front] = np.sqrt(np.linalg.eigvalsh(C)[:, -1]) if front.any() else []
    return PredictedMeasurement(T, state.pose_covariance, pixels, sigma, _box(pixels[front], sigma[front], camera))


def _box(pixels: Pixels, sigma: Float[np.ndarray, "n"], camera: Camera) -> Box:
    if len(pixels) == 0:
        return np.full(4, np.nan)
    margin = _SIGMAS * sigma[:, None]
    size = np.array([camera.width, camera.height], dtype=np.float64)
    low, high = (pixels - margin).min(axis=0), (pixels + margin).max(axis=0)
    if (low >= size).any() or (high <= 0.0).any():
        return np.full(4, np.nan)
    return np.concatenate([np.clip(low, 0.0, size), np.clip(high, 0.0, size)])
