"""What a renderer gives back: linear radiance and exact geometry over a window of the image."""

from dataclasses import dataclass

import numpy as np


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
class Frame:
    """One rendered window through the camera, lens distortion included; arrays are row-major, first row on top."""

    window: Window
    radiance: np.ndarray
    """(h, w, 3) float32, W/(m^2 sr) in the bands 600-700, 500-600 and 400-500 nm; linear, never tone-mapped."""
    depth_m: np.ndarray
    """(h, w) float32, z in the camera frame at the pixel's centre; inf where the centre sees no target."""
    part: np.ndarray
    """(h, w) int16, index of the target's part at the pixel's centre; -1 where there is none."""
    coverage: np.ndarray
    """(h, w) float32 in [0, 1], share of the pixel that the target covers."""

    @property
    def mask(self) -> np.ndarray:
        """(h, w) bool, target at the pixel's centre."""
        return self.part >= 0
