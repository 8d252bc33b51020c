"""Topics as ROS 2 names and serves them on DDS."""

from typing import Any, Literal

from proxnav.errors import InputError
from proxnav.live.ros2.installed import core, domain, pub, sub
from proxnav.live.ros2.installed import topic as dds

Profile = Literal["sensor_data", "reliable", "tf"]
"""sensor_data: best effort, the newest five, as rclpy's qos_profile_sensor_data; reliable: the last ten, as rclpy's
default; tf: reliable, the last hundred."""
_DEPTHS: dict[Profile, int] = {"sensor_data": 5, "reliable": 10, "tf": 100}
_BLOCKING_NS = 100_000_000


def dds_name(topic: str) -> str:
    """The name on DDS of a ROS topic.

    >>> dds_name("/camera/image_raw")
    'rt/camera/image_raw'
    """
    bare = topic.strip("/")
    if not bare or any(not (c.isalnum() or c in "_/") for c in bare) or "//" in bare:
        raise InputError(f"'{topic}' is no topic of ROS: letters, digits, _ and / between names, as /camera/image_raw")
    return f"rt/{bare}"


def qos(profile: Profile) -> Any:
    """The quality of service of a profile of ROS."""
    policy = core.Policy
    reliability = (
        policy.Reliability.BestEffort if profile == "sensor_data" else policy.Reliability.Reliable(_BLOCKING_NS)
    )
    return core.Qos(policy.History.KeepLast(_DEPTHS[profile]), reliability, policy.Durability.Volatile)


def reader(participant: domain.DomainParticipant, topic: str, kind: Any, profile: Profile) -> Any:
    """A reader; one with `sensor_data` hears reliable writers, too."""
    return sub.DataReader(participant, dds.Topic(participant, dds_name(topic), kind), qos(profile))


def writer(participant: domain.DomainParticipant, topic: str, kind: Any, profile: Profile) -> Any:
    """A writer."""
    return pub.DataWriter(participant, dds.Topic(participant, dds_name(topic), kind), qos(profile))
