"""Which renderer draws frames, and how well."""

from dataclasses import dataclass
from typing import Literal

from proxnav.errors import InputError

Renderer = Literal["cycles", "raycast"]


@dataclass(frozen=True)
class FrameConfig:
    """How frames are drawn."""

    renderer: Renderer = "cycles"
    """Blender's path tracer, or our ray caster: the same scenes, one to two orders of magnitude faster."""
    samples: int = 32
    """Cycles: samples per pixel."""
    threads: int = 0
    """Cycles: threads per worker; 0 takes all cores."""

    def __post_init__(self) -> None:
        if self.samples < 1:
            raise InputError(f"--samples must be at least 1, found {self.samples}")
