"""Poses made exact by the outline of the target in the image."""

from proxnav.pose.alignment.align import Alignment, align
from proxnav.pose.alignment.config import AlignConfig
from proxnav.pose.alignment.prior import Prior

__all__ = ["AlignConfig", "Alignment", "Prior", "align"]
