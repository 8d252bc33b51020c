"""The fast renderer: Embree finds what rays meet, numba shades it."""

from proxnav.rendering.raycast.config import RaycastConfig
from proxnav.rendering.raycast.renderer import RaycastRenderer

__all__ = ["RaycastConfig", "RaycastRenderer"]
