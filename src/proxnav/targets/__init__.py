"""Spacecraft models: generated, or read from CAD."""

from proxnav.targets.surface.material import Material
from proxnav.targets.target import Target

__all__ = ["Material", "Target"]
