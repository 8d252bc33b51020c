"""Images as the detectors read them: grey, eight bit, in the camera's size."""

import cv2
import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera

_LEAST_RANGE = 4
"""Counts between the darkest and the brightest pixel below which an image is empty."""


def grey_8_bit(image: np.ndarray, bits: int | None = None) -> np.ndarray:
    """A uint8/uint16 image, grey (h, w) or RGB (h, w, 3), as grey uint8; `bits` of a uint16 image are found if None."""
    if image.dtype not in (np.uint8, np.uint16) or image.ndim not in (2, 3) or 0 in image.shape:
        raise InputError(
            f"an image must be uint8 or uint16, (height, width) or (height, width, 3); "
            f"found {image.dtype} of shape {image.shape}"
        )
    if image.ndim == 3:
        image = image[..., 0] if image.shape[2] == 1 else cv2.cvtColor(image[..., :3], cv2.COLOR_RGB2GRAY)
    if image.dtype == np.uint16:
        bits = max(8, int(image.max()).bit_length()) if bits is None else bits
        image = (image >> (bits - 8)).astype(np.uint8)
    return np.ascontiguousarray(image)


def check_size(image: np.ndarray, camera: Camera) -> None:
    """InputError when the image is not of the camera's size."""
    height, width = image.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise InputError(
            f"the image is {width}x{height} px, the camera {camera.width}x{camera.height} px; "
            "give the camera.json of these images or resize the camera with them"
        )


def is_blank(grey: np.ndarray) -> bool:
    """Whether an image holds nothing to look at: black, saturated or of one tone."""
    return int(grey.max()) - int(grey.min()) < _LEAST_RANGE
