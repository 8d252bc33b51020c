"""How the image moves during the exposure: the target by its own motion, what is far away by the camera's rotation."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera
from proxnav.records import ExposureSpec


def target_velocity_px(
    point_cam_m: Float[np.ndarray, "3"], exposure: ExposureSpec, camera: Camera
) -> Float[np.ndarray, "2"]:
    """Image velocity [px/s] of a point of the target, which moves as its origin does: J v.

    The target's own rotation is left out: at 1 deg/s and 2 m from its origin it adds 35 um in 1 ms.
    """
    r = np.asarray(point_cam_m, dtype=np.float64)
    return camera.projection_jacobian(r) @ np.array(exposure.v_cam_target_mps)


def background_velocity_px(
    ray_cam: Float[np.ndarray, "3"], exposure: ExposureSpec, camera: Camera
) -> Float[np.ndarray, "2"]:
    """Image velocity [px/s] of what is infinitely far along a ray: J (-omega x ray)."""
    ray = np.asarray(ray_cam, dtype=np.float64)
    return camera.projection_jacobian(ray) @ -np.cross(exposure.omega_cam_radps, ray)


def is_still(exposure: ExposureSpec) -> bool:
    """Whether nothing moves."""
    return not any(exposure.v_cam_target_mps) and not any(exposure.omega_cam_radps)
