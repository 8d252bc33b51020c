"""The nouns that travel between the rooms; every stage takes and gives these and nothing else."""

from proxnav.records.estimates import Keypoints, PoseResult
from proxnav.records.frame_label import HIDDEN, NOT_IN_IMAGE, VISIBLE, FrameLabel
from proxnav.records.navigation import (
    NAV_ERRORS,
    NAV_STATUSES,
    AccelerometerData,
    Antennas,
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
from proxnav.records.rendered_frame import RenderedFrame, Window
from proxnav.records.scene import EarthSpec, SceneSpec, SunSpec, TextureSpec
from proxnav.records.sensor import ExposureSpec, SensorSpec
from proxnav.records.sky import Sky
from proxnav.records.trajectory import Trajectory

__all__ = [
    "HIDDEN",
    "NAV_ERRORS",
    "NAV_STATUSES",
    "NOT_IN_IMAGE",
    "VISIBLE",
    "AccelerometerData",
    "Antennas",
    "EarthSpec",
    "EphemerisData",
    "ExposureSpec",
    "FrameLabel",
    "GnssData",
    "GyroData",
    "KeypointData",
    "Keypoints",
    "NavState",
    "NavStatus",
    "PoseData",
    "PoseResult",
    "RenderedFrame",
    "SceneSpec",
    "SensorRecords",
    "SensorSpec",
    "Sky",
    "StarTrackerData",
    "SunSpec",
    "TextureSpec",
    "Trajectory",
    "Window",
]
