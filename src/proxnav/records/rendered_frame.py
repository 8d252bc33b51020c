"""What a renderer gives back: linear radiance and exact geometry over a window of the image."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float32, Int16


@dataclass(frozen=True, slots=True)
class Window:
    """A rectangle of whole pixels in the full image."""

    x: int
    y: int
    width: int
    height: int

    @property
    def slices(self) -> tuple[slice, slice]:
        """(rows, columns) of the window in a full-size array."""
        return slice(self.y, self.y + self.height), slice(self.x, self.x + self.width)


@dataclass(frozen=True, slots=True, eq=False)
class RenderedFrame:
    """One rendered window through the camera, lens distortion included; arrays are row-major, first row on top."""

    window: Window
    radiance: Float32[np.ndarray, "h w band=3"]
    """Linear radiance [W/(m^2 sr)] in the bands 600-700, 500-600 and 400-500 nm, never tone-mapped."""
    depth_m: Float32[np.ndarray, "h w"]
    """Depth z in the camera frame at the pixel's centre; inf where the centre sees no target."""
    part: Int16[np.ndarray, "h w"]
    """Index of the target's part at the pixel's centre; -1 where there is none."""
    coverage: Float32[np.ndarray, "h w"]
    """Share of the pixel that the target covers, 0 to 1."""

    @property
    def mask(self) -> Bool[np.ndarray, "h w"]:
        """Whether the target is at the pixel's centre."""
        return self.part >= 0
