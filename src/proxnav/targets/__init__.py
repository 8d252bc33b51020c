"""Spacecraft models: generated, or read from CAD.

cad/         mesh files: triangles, parts, axes, unit      surface/      materials, texture coordinates, looks
keypoints/   points that are looked for: chosen, judged    space_rider/  a spacecraft made of parameters
"""

from proxnav.targets.surface.material import Material
from proxnav.targets.target import Target

__all__ = ["Material", "Target"]
