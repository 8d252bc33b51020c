"""Earth, Sun and sky per ray: background, reflection and light for both renderers."""

from proxnav.rendering.earth.background import background_image, background_radiance, environment_map
from proxnav.rendering.earth.stars import stars

__all__ = ["background_image", "background_radiance", "environment_map", "stars"]
