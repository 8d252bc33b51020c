"""What the detector may expect in the next frame: where the target is, how it is turned, and how sure that is."""

from dataclasses import dataclass

import numpy as np

from proxnav.geometry import Camera, Pose, so3
from proxnav.geometry.types import Points
from proxnav.records import NavState

_SIGMAS = 3.0


@dataclass(frozen=True, slots=True, eq=False)
class ViewPrediction:
    """Pose and box of the target as the filter expects them."""

    T_cam_target: Pose
    covariance: np.ndarray
    """(6, 6) of (dt, dr) in camera axes, as PoseResult has it."""
    keypoints_px: np.ndarray
    """(k, 2); NaN behind the camera."""
    keypoint_sigma_px: np.ndarray
    """(k,) largest standard deviation of each predicted keypoint."""
    box_xyxy: np.ndarray
    """(4,) holds the given points with three standard deviations around them, cut at the image; NaN when outside."""


def predict_view(state: NavState, points_m: Points, camera: Camera) -> ViewPrediction:
    """Expectation for a frame at the time of `state`; `points_m`: keypoints, or the mesh's vertices for a full box."""
    T = Pose.from_wxyz("cam", "target", state.q_cam_target, state.t_cam_target_m)
    cam = T @ points_m
    pixels = camera.project(cam)
    front = np.isfinite(pixels[:, 0])
    J = np.full((len(points_m), 2, 6), np.nan)
    turned = points_m[front] @ T.R.T
    J_pi = camera.projection_jacobian(cam[front])
    J[front] = np.concatenate([J_pi, -J_pi @ so3.skew(turned)], axis=-1)
    C = J[front] @ state.pose_covariance @ np.swapaxes(J[front], -1, -2)
    sigma = np.full(len(points_m), np.nan)
    sigma[front] = np.sqrt(np.linalg.eigvalsh(C)[:, -1]) if front.any() else []
    return ViewPrediction(T, state.pose_covariance, pixels, sigma, _box(pixels[front], sigma[front], camera))


def _box(pixels: np.ndarray, sigma: np.ndarray, camera: Camera) -> np.ndarray:
    if len(pixels) == 0:
        return np.full(4, np.nan)
    margin = _SIGMAS * sigma[:, None]
    size = np.array([camera.width, camera.height], dtype=np.float64)
    low, high = (pixels - margin).min(axis=0), (pixels + margin).max(axis=0)
    if (low >= size).any() or (high <= 0.0).any():
        return np.full(4, np.nan)
    return np.concatenate([np.clip(low, 0.0, size), np.clip(high, 0.0, size)])
