"""ESA's Space Rider with its orbital module, generated from parameters.

Target frame: origin half-way between nose tip and nozzle exit on the stack's axis, +x forward to the nose, +y right
wing, +z down through the belly (to nadir in the observed attitude).
"""

from proxnav.targets.space_rider.params import SpaceRiderParams
from proxnav.targets.space_rider.stack import space_rider

__all__ = ["SpaceRiderParams", "space_rider"]
