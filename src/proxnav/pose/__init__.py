"""Pose with covariance from keypoints."""

from proxnav.pose.config import PoseConfig

__all__ = ["PoseConfig"]
