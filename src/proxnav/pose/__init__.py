"""Pose with covariance from keypoints."""

from proxnav.pose.solve.config import PoseConfig

__all__ = ["PoseConfig"]
