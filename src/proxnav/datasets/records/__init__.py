"""The nouns that travel between the rooms; every stage takes and gives these and nothing else."""

from proxnav.datasets.records.estimates import Keypoints, PoseResult
from proxnav.datasets.records.frame import Frame, Window
from proxnav.datasets.records.labels import HIDDEN, NOT_IN_IMAGE, VISIBLE, FrameLabel
from proxnav.datasets.records.navigation import (
    NAV_ERRORS,
    NAV_STATUSES,
    AccelerometerData,
    EphemerisData,
    GnssData,
    GyroData,
    KeypointData,
    NavState,
    NavStatus,
    PoseData,
    SensorRecords,
    StarTrackerData,
)
from proxnav.datasets.records.scene import EarthSpec, SceneSpec, SunSpec, TextureSpec
from proxnav.datasets.records.sensor import ExposureSpec, SensorSpec
from proxnav.datasets.records.trajectory import Trajectory

__all__ = [
    "HIDDEN",
    "NAV_ERRORS",
    "NAV_STATUSES",
    "NOT_IN_IMAGE",
    "VISIBLE",
    "AccelerometerData",
    "EarthSpec",
    "EphemerisData",
    "ExposureSpec",
    "Frame",
    "FrameLabel",
    "GnssData",
    "GyroData",
    "KeypointData",
    "Keypoints",
    "NavState",
    "NavStatus",
    "PoseData",
    "PoseResult",
    "SceneSpec",
    "SensorRecords",
    "SensorSpec",
    "StarTrackerData",
    "SunSpec",
    "TextureSpec",
    "Trajectory",
    "Window",
]
