"""The square of whole pixels that the network looks at, and the way there and back."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Shaped

from proxnav.geometry.types import Box, Pixels


@dataclass(frozen=True, slots=True)
class Crop:
    """A square of the image; it may reach beyond the image, where it reads as black."""

    x: int
    """Left edge [px]."""
    y: int
    """Upper edge [px]."""
    size: int
    """Side [px]."""

    @staticmethod
    def around(box_xyxy: Box, margin: float, least: int = 32) -> "Crop":
        """The crop about a box whose side is `margin` times the longer side of the box, `least` px at least."""
        x0, y0, x1, y1 = box_xyxy
        size = max(int(np.ceil(margin * max(x1 - x0, y1 - y0))), least)
        return Crop(round((x0 + x1 - size) / 2), round((y0 + y1 - size) / 2), size)

    def to_network(self, pixels: Pixels, side: int) -> Pixels:
        """Image pixels to pixels of the crop resampled to `side`; corner origin on both."""
        return (pixels - (self.x, self.y)) * (side / self.size)

    def to_image(self, pixels: Pixels, side: int) -> Pixels:
        """Inverse of `to_network`."""
        return pixels * (self.size / side) + (self.x, self.y)


def cut(image: Shaped[np.ndarray, "height width"], crop: Crop, side: int) -> Shaped[np.ndarray, "side side"]:
    """The crop of a grey image, resampled; black beyond the image."""
    height, width = image.shape
    x0, y0 = max(crop.x, 0), max(crop.y, 0)
    x1, y1 = min(crop.x + crop.size, width), min(crop.y + crop.size, height)
    if (x0, y0, x1, y1) == (crop.x, crop.y, crop.x + crop.size, crop.y + crop.size):
        return resample(image[y0:y1, x0:x1], side)
    square = np.zeros((crop.size, crop.size), image.dtype)
    if x1 > x0 and y1 > y0:
        square[y0 - crop.y : y1 - crop.y, x0 - crop.x : x1 - crop.x] = image[y0:y1, x0:x1]
    return resample(square, side)


def resample(square: Shaped[np.ndarray, "size size"], side: int) -> Shaped[np.ndarray, "side side"]:
    """A square image at another size: area mean when it shrinks, bilinear when it grows; corner origin kept."""
    if square.shape[0] == side:
        return square
    method = cv2.INTER_AREA if square.shape[0] > side else cv2.INTER_LINEAR
    return cv2.resize(square, (side, side), interpolation=method)
