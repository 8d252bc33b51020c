"""A known mesh followed from image to image, without a network."""

from proxnav.pose.track.motion import Motion
from proxnav.pose.track.tracker import Start, Tracker

__all__ = ["Motion", "Start", "Tracker"]
