"""The picture that a file lays over a part, as a repeating tile that both renderers look up pixel by pixel."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from jaxtyping import Float, Float32, UInt8

from proxnav.errors import InputError
from proxnav.geometry.arrays import frozen


@dataclass(frozen=True, slots=True, eq=False)
class PartImage:
    """Base colour over one repeating tile of a part, laid out as in `PartTexture`.

    Rows and columns are powers of two, as the levels of coarser texels need them.
    """

    tile_m: float
    """Length [m] along u and v after which it repeats."""
    srgb: UInt8[np.ndarray, "h w 3"]
    """Colours as the file stores them, red first."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "srgb", frozen(self.srgb, (None, None, 3), "srgb", np.uint8))
        h, w = self.srgb.shape[:2]
        if min(h, w) < 1 or h & (h - 1) or w & (w - 1) or not 0 < self.tile_m < 1e6:
            raise InputError(f"an image of {h} x {w} texels over {self.tile_m} m; expected powers of two and a length")


@lru_cache(maxsize=64)
def linear_texels(image: PartImage) -> Float32[np.ndarray, "h w 3"]:
    """Linear reflectance of every texel."""
    return _DECODED[image.srgb]


def srgb_to_linear(values: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """IEC 61966-2-1 decoding of values in [0, 1]."""
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def linear_to_srgb(values: Float[np.ndarray, "*shape"]) -> Float[np.ndarray, "*shape"]:
    """IEC 61966-2-1 encoding of values in [0, 1]."""
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * np.maximum(values, 0.0) ** (1 / 2.4) - 0.055)


_DECODED = srgb_to_linear(np.arange(256) / 255.0).astype(np.float32)
