"""Earth, Sun and sky per ray: background, reflection and light for both renderers."""

from proxnav.rendering.earth.background import background_image, background_radiance, environment_map

__all__ = ["background_image", "background_radiance", "environment_map"]
