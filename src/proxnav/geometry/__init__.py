"""Poses, quaternions and cameras: what every other room stands on."""

from proxnav.geometry.camera import Camera
from proxnav.geometry.pose import Pose

__all__ = ["Camera", "Pose"]
