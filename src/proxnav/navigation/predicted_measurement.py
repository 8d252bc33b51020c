"""What the detector may expect in the next frame: where the target is, how it is turned, and how sure that is."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose
from proxnav.geometry.boxes import box_in_image
from proxnav.geometry.pose_jacobian import pose_jacobian
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
    box_xyxy: Box | None
    """Box [px] of the given points with three standard deviations around each, cut at the image; None when outside."""


def predict_measurement(state: NavState, points_m: Points, camera: Camera) -> PredictedMeasurement:
    """Expectation for a frame at the time of `state`; `points_m`: keypoints, or the mesh's vertices for a full box."""
    T = Pose.from_wxyz("cam", "target", state.q_cam_target, state.t_cam_target_m)
    pixels = camera.project(T @ points_m)
    front = np.isfinite(pixels[:, 0])
    J = pose_jacobian(T, points_m[front], camera)
    sigma = np.full(len(points_m), np.nan)
    sigma[front] = np.sqrt(np.linalg.eigvalsh(J @ state.pose_covariance @ np.swapaxes(J, -1, -2))[:, -1])
    box = box_in_image(pixels, camera, _SIGMAS * sigma[:, None])
    return PredictedMeasurement(T, state.pose_covariance, pixels, sigma, box)
