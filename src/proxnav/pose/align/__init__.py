"""Poses refined on the outline of the target in the image."""

from proxnav.pose.align.align import CLEARLY, Alignment, align
from proxnav.pose.align.config import AlignConfig
from proxnav.pose.align.prior import Prior

__all__ = ["CLEARLY", "AlignConfig", "Alignment", "Prior", "align"]
