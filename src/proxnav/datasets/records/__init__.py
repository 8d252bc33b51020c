"""The nouns that travel between the rooms; every stage takes and gives these and nothing else."""

from proxnav.datasets.records.estimates import Keypoints, PoseResult
from proxnav.datasets.records.frame import Frame, Window
from proxnav.datasets.records.labels import HIDDEN, NOT_IN_IMAGE, VISIBLE, FrameLabel
from proxnav.datasets.records.scene import EarthSpec, SceneSpec, SunSpec, TextureSpec
from proxnav.datasets.records.sensor import ExposureSpec, SensorSpec
from proxnav.datasets.records.trajectory import Trajectory

__all__ = [
    "HIDDEN",
    "NOT_IN_IMAGE",
    "VISIBLE",
    "EarthSpec",
    "ExposureSpec",
    "Frame",
    "FrameLabel",
    "Keypoints",
    "PoseResult",
    "SceneSpec",
    "SensorSpec",
    "SunSpec",
    "TextureSpec",
    "Trajectory",
    "Window",
]
