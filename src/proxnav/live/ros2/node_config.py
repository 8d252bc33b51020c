"""Topics and frames of the node."""

from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True)
class NodeConfig:
    """What the node listens to and what it says."""

    image: str = "/camera/image_raw"
    """Topic of the images."""
    image_type: Literal["raw", "compressed"] = "raw"
    """sensor_msgs/Image or CompressedImage."""
    camera_info: str = "/camera/camera_info"
    imu: str = ""
    """Topic of an Imu in the frame of the camera; its rate takes the camera's own turning out of the odometry's twist.
    Empty: none."""
    prefix: str = "/proxnav"
    """Name before the topics of the answers: PREFIX/pose, PREFIX/odometry; /tf and /diagnostics stand by themselves."""
    target_frame: str = "target"
    """Frame of the target in tf: the axes of its CAD file."""
    camera_frame: str = "camera_optical_frame"
    """Frame of the camera (x right, y down, z forward) where images name none."""
    domain: int = 0
    """ROS_DOMAIN_ID."""
    oldest_s: float = 2.0
    """Age by the clock of this computer from which on an image is stale; 0 takes any, for played bags."""
    silent_s: float = 2.0
    """Time without images after which diagnostics say STALE."""
