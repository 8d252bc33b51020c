"""Modules of Basilisk (AVSLab, ISC licence): a rendered camera, a pose sensor, relative navigation."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_MODULES = {
    "PoseSensor": "pose_sensor",
    "RelativeNavigation": "relative_navigation",
    "RenderedCamera": "rendered_camera",
    "TruePoseSensor": "true_pose_sensor",
    "config_payload": "camera_config",
}
"""Name to file: each is imported when first used, and only then is Basilisk needed."""

__all__ = ["PoseSensor", "RelativeNavigation", "RenderedCamera", "TruePoseSensor", "config_payload"]

if TYPE_CHECKING:
    from proxnav.live.basilisk.camera_config import config_payload
    from proxnav.live.basilisk.pose_sensor import PoseSensor
    from proxnav.live.basilisk.relative_navigation import RelativeNavigation
    from proxnav.live.basilisk.rendered_camera import RenderedCamera
    from proxnav.live.basilisk.true_pose_sensor import TruePoseSensor


def __getattr__(name: str) -> Any:
    if name not in _MODULES:
        raise AttributeError(f"module 'proxnav.live.basilisk' has no attribute '{name}'")
    return getattr(import_module(f"proxnav.live.basilisk.{_MODULES[name]}"), name)
