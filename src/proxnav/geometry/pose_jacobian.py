"""How projected points move with the pose: d(pixels)/d(dt, dr), translation first."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion, so3
from proxnav.geometry.camera import Camera
from proxnav.geometry.pose import Pose
from proxnav.geometry.types import Points


def pose_jacobian(T_cam_target: Pose, points_target_m: Points, camera: Camera) -> Float[np.ndarray, "n_keypoints 2 6"]:
    """d(pixels)/d(dt, dr) for t + dt and exp(dr) R: J = [Jpi, -Jpi [R p]x], both in camera axes [px/m, px/rad]."""
    turned = points_target_m @ T_cam_target.R.T
    return _jacobian(turned + T_cam_target.t_m, so3.skew(turned), camera)


def pose_jacobians_target_axes(
    q_cam_target: Float[np.ndarray, "n_poses wxyz=4"],
    t_cam_target_m: Float[np.ndarray, "n_poses 3"],
    points_target_m: Points,
    camera: Camera,
) -> Float[np.ndarray, "n_poses n_keypoints 2 6"]:
    """The same of many poses for t + dt and R exp(dr): J = [Jpi, -Jpi R [p]x], the turn in target axes."""
    points_cam_m = quaternion.rotate(q_cam_target[:, None], points_target_m[None]) + t_cam_target_m[:, None]
    levers = quaternion.to_matrix(q_cam_target)[:, None] @ so3.skew(points_target_m)
    return _jacobian(points_cam_m, levers, camera)


def _jacobian(
    points_cam_m: Float[np.ndarray, "*batch 3"], levers: Float[np.ndarray, "*batch 3 3"], camera: Camera
) -> Float[np.ndarray, "*batch 2 6"]:
    J_pi = camera.projection_jacobian(points_cam_m)
    return np.concatenate([J_pi, -J_pi @ levers], axis=-1)
