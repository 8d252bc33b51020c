"""What a CameraConfigMsg says: intrinsics, and where on the chaser the camera sits."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.live.basilisk.attitude import q_n_b, sigma_bn


@dataclass(frozen=True, slots=True, eq=False)
class Mounting:
    """The camera on the chaser's body."""

    r_body_cam_m: Float[np.ndarray, "3"]
    """Camera's centre from the origin of the body axes, in these axes [m]."""
    q_body_cam: Float[np.ndarray, "wxyz=4"]

    def q_eci_cam(self, q_eci_body: QuatWxyz) -> QuatWxyz:
        """Attitude of the camera on a body of that attitude."""
        return quaternion.multiply(q_eci_body, self.q_body_cam)

    def in_cam(self, v_body: Vector3) -> Vector3:
        """Components in camera axes of a vector given in body axes."""
        return quaternion.rotate(quaternion.conjugate(self.q_body_cam), v_body)


def camera_of(config: Any) -> Camera:
    """The pinhole of a CameraConfigMsg payload: square pixels, a field of view from edge to edge along y.

    InputError where the message has no size or no field of view.
    """
    (width, height), fov = (int(n) for n in config.resolution), float(config.fieldOfView)
    if not (width > 0 and height > 0 and 0.0 < fov < np.pi):
        raise InputError(
            f"the CameraConfigMsg says {width}x{height} px and a field of view of {fov:g} rad: write resolution [px] "
            "and fieldOfView (rad, edge to edge along y) before the run"
        )
    f = 0.5 * height / np.tan(0.5 * fov)
    return Camera(width=width, height=height, fx=f, fy=f, cx=0.5 * width, cy=0.5 * height)


def mounting_of(config: Any) -> Mounting:
    """Place and attitude of the camera of a CameraConfigMsg payload."""
    return Mounting(np.array(config.cameraPos_B, dtype=np.float64), q_n_b(np.array(config.sigma_CB)))


def config_payload(camera: Camera, r_body_cam_m: Vector3, q_body_cam: QuatWxyz) -> Any:
    """CameraConfigMsg payload of a camera so mounted. InputError where that message cannot describe it."""
    from proxnav.live.basilisk.installed import messaging

    payload = messaging.CameraConfigMsgPayload()
    payload.cameraID, payload.isOn, payload.resolution = 1, 1, [camera.width, camera.height]
    payload.fieldOfView = field_of_view(camera)
    payload.cameraPos_B, payload.sigma_CB = list(r_body_cam_m), sigma_bn(q_body_cam).tolist()
    return payload


def field_of_view(camera: Camera) -> float:
    """`fieldOfView` [rad] of a CameraConfigMsg for a camera. InputError where that message cannot describe it."""
    square = np.isclose(camera.fx, camera.fy, rtol=1e-6)
    centred = np.allclose([camera.cx, camera.cy], [0.5 * camera.width, 0.5 * camera.height], atol=1e-3)
    if not (square and centred) or camera.is_distorted:
        raise InputError(
            "a CameraConfigMsg describes square pixels, a centred principal point and no distortion only, which this "
            "camera does not have: resample its images to such a pinhole"
        )
    return float(2.0 * np.arctan(0.5 * camera.height / camera.fy))
