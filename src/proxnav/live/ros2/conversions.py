"""Messages of ROS 2 to our values and back: stamps, pixels, calibrations, poses."""

from dataclasses import asdict

import numpy as np
from jaxtyping import Float, UInt8

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.geometry.camera_files.fields import Fields
from proxnav.geometry.camera_files.opencv_matrices import read_matrices
from proxnav.geometry.types import Image as Pixels2D
from proxnav.geometry.types import QuatWxyz
from proxnav.geometry.types import Vector3 as Vector
from proxnav.images.codecs import decode_image
from proxnav.live.ros2 import messages as ros
from proxnav.records import PoseResult

_LAYOUTS = {
    "mono8": (np.uint8, 1), "8UC1": (np.uint8, 1), "mono16": (np.uint16, 1), "16UC1": (np.uint16, 1),
    "rgb8": (np.uint8, 3), "8UC3": (np.uint8, 3), "bgr8": (np.uint8, 3),
}  # fmt: skip
"""Type and channels of the encodings that are read."""


def seconds(stamp: ros.Time) -> float:
    """Seconds since 1970."""
    return stamp.sec + 1e-9 * stamp.nanosec


def pixels_of(message: ros.Image | ros.CompressedImage) -> Pixels2D | None:
    """The picture, grey or RGB; None where the message has no bytes. InputError where they are no picture."""
    if len(message.data) == 0:
        return None
    if isinstance(message, ros.CompressedImage):
        return decode_image(message.data, "CompressedImage")
    return _raw(message, np.frombuffer(message.data, np.uint8))


def _raw(message: ros.Image, content: UInt8[np.ndarray, "n"]) -> Pixels2D:
    if message.encoding not in _LAYOUTS:
        raise InputError(
            f"Image: encoding '{message.encoding}' is not read, only {', '.join(_LAYOUTS)}: convert it, "
            "with image_proc for one"
        )
    kind, channels = _LAYOUTS[message.encoding]
    dtype = np.dtype(kind).newbyteorder(">" if message.is_bigendian else "<")
    row = message.width * channels * dtype.itemsize
    if message.step < row or len(content) < message.step * message.height or message.height < 1 or message.width < 1:
        raise InputError(
            f"Image: {len(content)} bytes in rows of {message.step} are no {message.width}x{message.height} px "
            f"{message.encoding}; it is damaged"
        )
    rows = content[: message.step * message.height].reshape(message.height, message.step)[:, :row]
    image = np.ascontiguousarray(rows).view(dtype).astype(kind).reshape(message.height, message.width, channels)
    if message.encoding == "bgr8":
        image = np.ascontiguousarray(image[..., ::-1])
    return image[..., 0] if channels == 1 else image


def camera_of(info: ros.CameraInfo) -> Camera:
    """The camera of the images that come with this calibration: region and binning are taken, pixels go corner-origin.

    InputError where it is not calibrated.
    """
    content = asdict(info)
    camera, _ = read_matrices(Fields({name: content[name] for name in content if name != "header"}, "CameraInfo"))
    return camera


def header(stamp: ros.Time, frame_id: str) -> ros.Header:
    """The header of an answer: the stamp of the question."""
    return ros.Header(stamp, frame_id)


def point_of(v: Vector) -> ros.Point:
    """A place [m]."""
    return ros.Point(*v.tolist())


def vector_of(v: Vector) -> ros.Vector3:
    """Three components."""
    return ros.Vector3(*v.tolist())


def quaternion_of(q_wxyz: QuatWxyz) -> ros.Quaternion:
    """Scalar last."""
    w, x, y, z = q_wxyz.tolist()
    return ros.Quaternion(x, y, z, w)


def wxyz_of(q: ros.Quaternion) -> QuatWxyz:
    """Inverse of `quaternion_of`."""
    return np.array([q.w, q.x, q.y, q.z])


def xyz_of(v: ros.Vector3 | ros.Point) -> Vector:
    """The three components."""
    return np.array([v.x, v.y, v.z])


def pose_of(T: Pose, covariance: Float[np.ndarray, "6 6"]) -> ros.PoseWithCovariance:
    """A pose with its covariance; ROS turns about the fixed axes of the header's frame, and so do we."""
    return ros.PoseWithCovariance(
        ros.Pose(point_of(T.t_m), quaternion_of(T.q_wxyz)), np.asarray(covariance).ravel().tolist()
    )


def stamped_pose(result: PoseResult, head: ros.Header) -> ros.PoseWithCovarianceStamped:
    """The answer to one image; only for results that hold a pose."""
    assert result.T_cam_target is not None
    assert result.covariance is not None
    return ros.PoseWithCovarianceStamped(head, pose_of(result.T_cam_target, result.covariance))


def transform_of(T: Pose, head: ros.Header, child: str) -> ros.TransformStamped:
    """tf: coordinates in the child frame to coordinates in the header's frame, which is T itself."""
    return ros.TransformStamped(head, child, ros.Transform(vector_of(T.t_m), quaternion_of(T.q_wxyz)))
