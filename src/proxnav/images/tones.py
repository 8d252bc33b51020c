"""Tones of images: counts of any converter as 8 bits, grey or colour."""

import cv2
import numpy as np
from jaxtyping import UInt8

from proxnav.errors import InputError
from proxnav.geometry.types import GreyImage, Image

_LEAST_RANGE = 4
"""Counts between the darkest and the brightest pixel below which an image is empty."""


def as_8_bit(image: Image, bits: int | None = None) -> UInt8[np.ndarray, "height width *rgb"]:
    """Counts of a converter of `bits` bits as uint8; without `bits` the brightest pixel tells how many there are."""
    if image.dtype == np.uint8:
        return image
    bits = int(image.max()).bit_length() if bits is None else bits
    return (image >> max(0, bits - 8)).astype(np.uint8)


def grey_8_bit(image: np.ndarray, bits: int | None = None) -> GreyImage:
    """A uint8/uint16 image, grey (h, w) or RGB (h, w, 3), as grey uint8; `bits` of a uint16 image are found if None."""
    if image.dtype not in (np.uint8, np.uint16) or image.ndim not in (2, 3) or 0 in image.shape:
        raise InputError(
            f"an image must be uint8 or uint16, (height, width) or (height, width, 3); "
            f"found {image.dtype} of shape {image.shape}"
        )
    if image.ndim == 3:
        image = image[..., 0] if image.shape[2] == 1 else cv2.cvtColor(image[..., :3], cv2.COLOR_RGB2GRAY)
    return np.ascontiguousarray(as_8_bit(image, bits))


def rgb_8_bit(image: Image) -> UInt8[np.ndarray, "height width 3"]:
    """A copy of a uint8/uint16 image, grey or RGB, as RGB uint8."""
    image = as_8_bit(image)
    return np.repeat(image[..., None], 3, axis=2) if image.ndim == 2 else image.copy()


def is_blank(grey: GreyImage) -> bool:
    """Whether an image holds nothing to look at: black, saturated or of one tone."""
    return int(grey.max()) - int(grey.min()) < _LEAST_RANGE
