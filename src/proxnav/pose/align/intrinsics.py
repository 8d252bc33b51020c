"""What errors of the camera's calibration do to a pose that lies on the image's edges."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Pose
from proxnav.geometry.pose_jacobian import pose_jacobian
from proxnav.pose.align.outline import outline
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.target_crop import TargetCrop
from proxnav.targets import Target


def outline_moves(
    target: Target, T_cam_target: Pose, crop: TargetCrop, prior: Prior, spacing_px: float, weight: float
) -> Float[np.ndarray, "6 calibration=3"]:
    """(dt, dr) of the aligned pose by one standard deviation of each error of the calibration.

    Edges pull along their normals n with J = n^T d(pixels)/d(pose), the prior's pose moves by itself, both together:
    dpose/dc = -(w J^T J + P)^-1 (w J^T n^T C - P dprior/dc), P the prior's information. w: of a point of the outline.
    """
    if crop.camera.calibration_sigma.is_exact:
        return np.zeros_like(prior.calibration_moves)
    lines, camera = outline(target, T_cam_target.R, T_cam_target.t_m, crop, spacing_px), crop.camera
    pixels = camera.project(T_cam_target @ lines.points_m)
    seen = np.isfinite(pixels[:, 0])
    points, normals, pixels = lines.points_m[seen], lines.normals[seen], pixels[seen]
    J = np.einsum("ka,kai->ki", normals, pose_jacobian(T_cam_target, points, camera))
    C = np.einsum("ka,kai->ki", normals, camera.calibration_sigma.moves(pixels - (camera.cx, camera.cy)))
    H = weight * J.T @ J + prior.information
    scale = 1.0 / np.sqrt(np.diagonal(H))[:, None]
    pull = weight * J.T @ C - prior.information @ prior.calibration_moves
    return -scale * np.linalg.solve(H * scale * scale.T, scale * pull)
