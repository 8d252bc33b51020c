"""Earth, Sun and sky per ray: background, reflection and light for both renderers."""
