"""Messages of ROS 2 as DDS carries them: the names of `rosidl`, the layout of common_interfaces and tf2_msgs.

The types on the wire are `pkg::msg::dds_::Type_`. Images declare `sequence[uint8]`, which is their type to others, and
travel through a twin with `bytes`: as a list of numbers a megapixel takes half a second.
"""

# DDS reads the annotations of these classes as they stand: no `from __future__ import annotations`.
# pyright: reportInvalidTypeForm=false

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

from proxnav.live.ros2.installed import idl
from proxnav.live.ros2.installed import idl_types as t

if TYPE_CHECKING:
    Octets, Doubles, Nine, Twelve, ThirtySix = bytes, list[float], list[float], list[float], list[float]
else:
    Octets, Doubles = t.sequence[t.uint8], t.sequence[t.float64]
    Nine, Twelve, ThirtySix = (t.array[t.float64, count] for count in (9, 12, 36))


def _as(kind: Any, message: Any) -> Any:
    """The same fields as a message of that kind."""
    return kind(*(getattr(message, part.name) for part in fields(message)))


def _numbers(count: int) -> list[float]:
    return [0.0] * count


@dataclass
class Time(idl.IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    """Seconds since 1970, UTC."""

    sec: t.int32 = 0
    nanosec: t.uint32 = 0


@dataclass
class Header(idl.IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    """When, and in which frame."""

    stamp: Time = field(default_factory=Time)
    frame_id: str = ""


@dataclass
class _ImageInOnePiece(idl.IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    header: Header = field(default_factory=Header)
    height: t.uint32 = 0
    width: t.uint32 = 0
    encoding: str = ""
    is_bigendian: t.uint8 = 0
    step: t.uint32 = 0
    data: bytes = b""


@dataclass
class Image(idl.IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    """Pixels as the driver has them; `data` is bytes."""

    header: Header = field(default_factory=Header)
    height: t.uint32 = 0
    width: t.uint32 = 0
    encoding: str = ""
    is_bigendian: t.uint8 = 0
    step: t.uint32 = 0
    data: Octets = b""

    def serialize(self, buffer: Any = None, endianness: Any = None, use_version_2: bool | None = None) -> bytes:
        """The message on the wire."""
        return _as(_ImageInOnePiece, self).serialize(buffer, endianness, use_version_2)

    @classmethod
    def deserialize(cls, data: bytes, has_header: bool = True, use_version_2: bool | None = None) -> "Image":
        """Inverse of `serialize`."""
        return _as(cls, _ImageInOnePiece.deserialize(data, has_header, use_version_2))


@dataclass
class _CompressedInOnePiece(idl.IdlStruct, typename="sensor_msgs::msg::dds_::CompressedImage_"):
    header: Header = field(default_factory=Header)
    format: str = ""
    data: bytes = b""


@dataclass
class CompressedImage(idl.IdlStruct, typename="sensor_msgs::msg::dds_::CompressedImage_"):
    """A JPEG or PNG; `data` is bytes."""

    header: Header = field(default_factory=Header)
    format: str = ""
    data: Octets = b""

    def serialize(self, buffer: Any = None, endianness: Any = None, use_version_2: bool | None = None) -> bytes:
        """The message on the wire."""
        return _as(_CompressedInOnePiece, self).serialize(buffer, endianness, use_version_2)

    @classmethod
    def deserialize(cls, data: bytes, has_header: bool = True, use_version_2: bool | None = None) -> "CompressedImage":
        """Inverse of `serialize`."""
        return _as(cls, _CompressedInOnePiece.deserialize(data, has_header, use_version_2))


@dataclass
class RegionOfInterest(idl.IdlStruct, typename="sensor_msgs::msg::dds_::RegionOfInterest_"):
    """Part of the sensor that is delivered."""

    x_offset: t.uint32 = 0
    y_offset: t.uint32 = 0
    height: t.uint32 = 0
    width: t.uint32 = 0
    do_rectify: bool = False


@dataclass
class CameraInfo(idl.IdlStruct, typename="sensor_msgs::msg::dds_::CameraInfo_"):
    """Calibration; pixel (0, 0) is the centre of the first pixel."""

    header: Header = field(default_factory=Header)
    height: t.uint32 = 0
    width: t.uint32 = 0
    distortion_model: str = ""
    d: Doubles = field(default_factory=list)
    k: Nine = field(default_factory=lambda: _numbers(9))
    r: Nine = field(default_factory=lambda: _numbers(9))
    p: Twelve = field(default_factory=lambda: _numbers(12))
    binning_x: t.uint32 = 0
    binning_y: t.uint32 = 0
    roi: RegionOfInterest = field(default_factory=RegionOfInterest)


@dataclass
class Vector3(idl.IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    """x, y, z."""

    x: t.float64 = 0.0
    y: t.float64 = 0.0
    z: t.float64 = 0.0


@dataclass
class Point(idl.IdlStruct, typename="geometry_msgs::msg::dds_::Point_"):
    """Place [m]."""

    x: t.float64 = 0.0
    y: t.float64 = 0.0
    z: t.float64 = 0.0


@dataclass
class Quaternion(idl.IdlStruct, typename="geometry_msgs::msg::dds_::Quaternion_"):
    """Scalar last."""

    x: t.float64 = 0.0
    y: t.float64 = 0.0
    z: t.float64 = 0.0
    w: t.float64 = 1.0


@dataclass
class Pose(idl.IdlStruct, typename="geometry_msgs::msg::dds_::Pose_"):
    """Place and attitude of a frame in the header's."""

    position: Point = field(default_factory=Point)
    orientation: Quaternion = field(default_factory=Quaternion)


@dataclass
class PoseWithCovariance(idl.IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovariance_"):
    """Rows of the covariance: x, y, z, turns about the header's x, y, z."""

    pose: Pose = field(default_factory=Pose)
    covariance: ThirtySix = field(default_factory=lambda: _numbers(36))


@dataclass
class PoseWithCovarianceStamped(idl.IdlStruct, typename="geometry_msgs::msg::dds_::PoseWithCovarianceStamped_"):
    """A pose of one instant."""

    header: Header = field(default_factory=Header)
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)


@dataclass
class Twist(idl.IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    """Rates [m/s, rad/s]."""

    linear: Vector3 = field(default_factory=Vector3)
    angular: Vector3 = field(default_factory=Vector3)


@dataclass
class TwistWithCovariance(idl.IdlStruct, typename="geometry_msgs::msg::dds_::TwistWithCovariance_"):
    """Rates with their covariance."""

    twist: Twist = field(default_factory=Twist)
    covariance: ThirtySix = field(default_factory=lambda: _numbers(36))


@dataclass
class Odometry(idl.IdlStruct, typename="nav_msgs::msg::dds_::Odometry_"):
    """The pose in the header's frame, the twist in the child's."""

    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    pose: PoseWithCovariance = field(default_factory=PoseWithCovariance)
    twist: TwistWithCovariance = field(default_factory=TwistWithCovariance)


@dataclass
class Imu(idl.IdlStruct, typename="sensor_msgs::msg::dds_::Imu_"):
    """Rates [rad/s] and specific force [m/s^2] in the header's frame."""

    header: Header = field(default_factory=Header)
    orientation: Quaternion = field(default_factory=Quaternion)
    orientation_covariance: Nine = field(default_factory=lambda: _numbers(9))
    angular_velocity: Vector3 = field(default_factory=Vector3)
    angular_velocity_covariance: Nine = field(default_factory=lambda: _numbers(9))
    linear_acceleration: Vector3 = field(default_factory=Vector3)
    linear_acceleration_covariance: Nine = field(default_factory=lambda: _numbers(9))


@dataclass
class Transform(idl.IdlStruct, typename="geometry_msgs::msg::dds_::Transform_"):
    """Coordinates in the child frame to coordinates in the header's."""

    translation: Vector3 = field(default_factory=Vector3)
    rotation: Quaternion = field(default_factory=Quaternion)


@dataclass
class TransformStamped(idl.IdlStruct, typename="geometry_msgs::msg::dds_::TransformStamped_"):
    """A transform of one instant."""

    header: Header = field(default_factory=Header)
    child_frame_id: str = ""
    transform: Transform = field(default_factory=Transform)


Transforms = list[TransformStamped] if TYPE_CHECKING else t.sequence[TransformStamped]


@dataclass
class TFMessage(idl.IdlStruct, typename="tf2_msgs::msg::dds_::TFMessage_"):
    """Transforms for everybody's tree."""

    transforms: Transforms = field(default_factory=list)


@dataclass
class KeyValue(idl.IdlStruct, typename="diagnostic_msgs::msg::dds_::KeyValue_"):
    """One number for people."""

    key: str = ""
    value: str = ""


KeyValues = list[KeyValue] if TYPE_CHECKING else t.sequence[KeyValue]


@dataclass
class DiagnosticStatus(idl.IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticStatus_"):
    """How a part is doing; level 0 ok, 1 warning, 2 error, 3 stale."""

    level: t.byte = 0
    name: str = ""
    message: str = ""
    hardware_id: str = ""
    values: KeyValues = field(default_factory=list)


Statuses = list[DiagnosticStatus] if TYPE_CHECKING else t.sequence[DiagnosticStatus]


@dataclass
class DiagnosticArray(idl.IdlStruct, typename="diagnostic_msgs::msg::dds_::DiagnosticArray_"):
    """All parts."""

    header: Header = field(default_factory=Header)
    status: Statuses = field(default_factory=list)
