"""Tango, the target craft of PRISMA and of SPEED+, generated from parameters.

Target frame, that of SPEED+: origin on the bottom face, +z through the craft to the solar panel, +x and +y along the
panel's edges.
"""

from proxnav.targets.tango.craft import tango
from proxnav.targets.tango.params import TangoParams

__all__ = ["TangoParams", "tango"]
