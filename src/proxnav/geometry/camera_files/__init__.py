"""Calibration files of many makers as a `Camera`."""

from proxnav.geometry.camera_files.read import CameraFile, read_camera_file
from proxnav.geometry.camera_files.speed_camera import read_speed_json, speed_json

__all__ = ["CameraFile", "read_camera_file", "read_speed_json", "speed_json"]
