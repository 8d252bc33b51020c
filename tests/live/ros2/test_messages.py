"""Our messages are those of ROS 2, byte for byte: rosbags, which reads the definitions, is the judge."""

from typing import Any

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="Cyclone DDS is not installed: pip install cyclonedds")

from rosbags.typesys import Stores, get_typestore

from proxnav.live.ros2 import messages as ros
from proxnav.live.ros2.topics import dds_name

STORE = get_typestore(Stores.ROS2_JAZZY)
HEAD = ros.Header(ros.Time(1_790_000_000, 123_456_789), "camera_optical_frame")
POSE = ros.PoseWithCovariance(
    ros.Pose(ros.Point(1.0, 2.0, 3.0), ros.Quaternion(0.1, 0.2, 0.3, 0.9)), [float(i) for i in range(36)]
)
TWIST = ros.TwistWithCovariance(ros.Twist(ros.Vector3(1.0, 2.0, 3.0), ros.Vector3(4.0, 5.0, 6.0)), [0.5] * 36)
TRANSFORM = ros.TransformStamped(HEAD, "target", ros.Transform(ros.Vector3(1.0, 2.0, 3.0), ros.Quaternion()))
STATUS = ros.DiagnosticStatus(1, "name", "a sentence", "id", [ros.KeyValue("a", "1"), ros.KeyValue("bc", "2")])
MESSAGES = {
    "sensor_msgs/msg/Image": ros.Image(HEAD, 2, 3, "mono8", 0, 3, bytes(range(6))),
    "sensor_msgs/msg/CompressedImage": ros.CompressedImage(HEAD, "jpeg", b"\xff\xd8\xff"),
    "sensor_msgs/msg/CameraInfo": ros.CameraInfo(
        HEAD, 2, 3, "plumb_bob", [0.1, 0.2], [1.0] * 9, [2.0] * 9, [3.0] * 12, 1, 2,
        ros.RegionOfInterest(1, 2, 3, 4, True),
    ),
    "sensor_msgs/msg/Imu": ros.Imu(HEAD, angular_velocity=ros.Vector3(1.0, 2.0, 3.0)),
    "geometry_msgs/msg/PoseWithCovarianceStamped": ros.PoseWithCovarianceStamped(HEAD, POSE),
    "nav_msgs/msg/Odometry": ros.Odometry(HEAD, "target", POSE, TWIST),
    "tf2_msgs/msg/TFMessage": ros.TFMessage([TRANSFORM, TRANSFORM]),
    "diagnostic_msgs/msg/DiagnosticArray": ros.DiagnosticArray(HEAD, [STATUS]),
}  # fmt: skip


def plain(value: Any) -> Any:
    """Nested values of either library as lists, numbers and strings."""
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, bytes):
        return list(value)
    if isinstance(value, list):
        return [plain(item) for item in value]
    names = [name for name in getattr(value, "__dataclass_fields__", {}) if name.islower() and name != "__msgtype__"]
    return {name: plain(getattr(value, name)) for name in names} if names else value


@pytest.mark.parametrize("name", MESSAGES)
def test_rosbags_reads_what_we_write_and_we_read_what_it_writes(name: str) -> None:
    ours = MESSAGES[name]
    theirs = STORE.deserialize_cdr(ours.serialize(), name)
    assert plain(theirs) == plain(ours)
    back = type(ours).deserialize(bytes(STORE.serialize_cdr(theirs, name)))
    assert plain(back) == plain(ours)


@pytest.mark.parametrize("name", MESSAGES)
def test_types_have_the_names_that_ros_gives_them_on_dds(name: str) -> None:
    package, _, kind = name.split("/")
    assert type(MESSAGES[name]).__idl_typename__ == f"{package}::msg::dds_::{kind}_"


def test_topics_have_the_prefix_of_ros() -> None:
    assert dds_name("/camera/image_raw") == dds_name("camera/image_raw") == "rt/camera/image_raw"
