"""How well a pose can be known at best from noisy keypoints: the Cramer-Rao bound."""

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.pose_jacobian import pose_jacobian
from proxnav.geometry.types import Points


def cramer_rao(
    T_cam_target: Pose, points_target_m: Points, camera: Camera, covariances_px2: Float[np.ndarray, "n_keypoints 2 2"]
) -> Float[np.ndarray, "6 6"]:
    """Least covariance of (dt [m], dr [rad]) of any unbiased pose from these keypoints: (sum J^T S^-1 J)^-1.

    All given points count as seen; leave out those that are not. InputError where they do not determine a pose.
    """
    J = pose_jacobian(T_cam_target, points_target_m, camera)
    H = np.einsum("nia,nij,njb->ab", J, np.linalg.inv(covariances_px2), J)
    scale = 1.0 / np.sqrt(np.diagonal(H))
    scaled = H * scale * scale[:, None]
    if not np.isfinite(scaled).all() or np.linalg.cond(scaled) > 1e12:
        raise InputError(
            f"{len(points_target_m)} keypoints at this pose do not determine all six degrees of freedom: "
            "give at least 3 that are not on one line and are in front of the camera"
        )
    covariance = np.linalg.inv(scaled) * scale * scale[:, None]
    return 0.5 * (covariance + covariance.T)


def cramer_rao_white(
    T_cam_target: Pose, points_target_m: Points, camera: Camera, sigma_px: float = 1.0
) -> Float[np.ndarray, "6 6"]:
    """`cramer_rao` with the same noise on each axis of each keypoint.

    >>> camera = Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
    >>> cube = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    >>> T = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 50.0])
    >>> np.sqrt(np.diag(cramer_rao_white(T, cube, camera)))[:3].round(3)
    array([0.013, 0.013, 0.443])
    """
    return cramer_rao(
        T_cam_target, points_target_m, camera, np.tile(sigma_px**2 * np.eye(2), (len(points_target_m), 1, 1))
    )
