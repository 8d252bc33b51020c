"""Errors, tables and bounds."""

from proxnav.evaluation.errors import PoseErrors, pose_errors
from proxnav.evaluation.summary import Summary, summarise

__all__ = ["PoseErrors", "Summary", "pose_errors", "summarise"]
