"""A node of ROS 2 over DDS, without a ROS installation."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_MODULES = {"NodeConfig": "node_config", "PoseNode": "node"}
"""Name to file: each is imported when first used, and only then is Cyclone DDS needed."""

__all__ = ["NodeConfig", "PoseNode"]

if TYPE_CHECKING:
    from proxnav.live.ros2.node import PoseNode
    from proxnav.live.ros2.node_config import NodeConfig


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'proxnav.live.ros2' has no attribute '{name}'")
    return getattr(import_module(f"proxnav.live.ros2.{_MODULES[name]}"), name)
