"""What a craft knows of its surroundings besides the picture."""

from dataclasses import dataclass

from proxnav.geometry.types import Vector3


@dataclass(frozen=True, slots=True, eq=False)
class Sky:
    """Where Sun and Earth stand, as star tracker and ephemeris tell."""

    sun_cam: Vector3
    """Direction to the Sun, camera axes."""
    nadir_cam: Vector3 | None = None
    """Direction to Earth's centre, camera axes; None lights the target by the Sun alone."""
    sun_visible: float = 1.0
    """Share of the Sun's disc that lights the target: 0 in umbra."""
