"""What errors of the camera's calibration do to a pose that keypoints have given."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose
from proxnav.geometry.calibration import pose_moves
from proxnav.geometry.pose_jacobian import pose_jacobian
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.consensus import Fit, robust_weights
from proxnav.pose.solve.intake import Correspondences
from proxnav.records.estimates import NO_MOVES

Moves = Float[np.ndarray, "6 calibration=3"]
"""(dt [m], dr [rad]) of the pose by one standard deviation of each error of the calibration."""


def intrinsics_moves(
    fit: Fit, data: Correspondences, T_cam_target: Pose, camera: Camera, config: PoseConfig
) -> tuple[Moves, float]:
    """(movement of the pose, mean sum of squared normalised errors that the pose cannot take up); zeros if exact."""
    if camera.calibration_sigma.is_exact:
        return NO_MOVES, 0.0
    points = data.X[fit.use] + data.centroid
    J = pose_jacobian(T_cam_target, points, camera)
    a, b, c = fit.info[fit.use].T
    W = robust_weights(fit, data, config)[fit.use, None, None] * np.moveaxis(np.array([[a, b], [b, c]]), -1, 0)
    C = camera.calibration_sigma.moves(camera.project(T_cam_target @ points) - (camera.cx, camera.cy))
    S = pose_moves(J, W, C)
    left = C + J @ S
    return S, float(np.einsum("kai,kab,kbi->", left, W, left))
