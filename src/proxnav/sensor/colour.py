"""The Bayer mosaic (RGGB, red at even row and even column of the full image), and a plain way back for viewing."""

import cv2
import numpy as np
from jaxtyping import Float, UInt8, UInt16

from proxnav.records import Window


def mosaic(image: Float[np.ndarray, "height width band=3"], window: Window) -> Float[np.ndarray, "height width"]:
    """What lies under the colour filters: one band per pixel."""
    raw = np.ascontiguousarray(image[..., 1])
    red_row, red_column = window.y % 2, window.x % 2
    raw[red_row::2, red_column::2] = image[red_row::2, red_column::2, 0]
    raw[1 - red_row :: 2, 1 - red_column :: 2] = image[1 - red_row :: 2, 1 - red_column :: 2, 2]
    return raw


def demosaic(
    raw: UInt8[np.ndarray, "height width"] | UInt16[np.ndarray, "height width"], window: Window | None = None
) -> UInt8[np.ndarray, "height width rgb=3"] | UInt16[np.ndarray, "height width rgb=3"]:
    """Red, green and blue in the type of the mosaic, by OpenCV's bilinear interpolation."""
    odd = (window.y % 2, window.x % 2) if window else (0, 0)
    # OpenCV names a pattern by the second and third pixel of the second row: RGGB is its "BayerBG"
    codes = {
        (0, 0): cv2.COLOR_BayerBG2RGB,
        (0, 1): cv2.COLOR_BayerGB2RGB,
        (1, 0): cv2.COLOR_BayerGR2RGB,
        (1, 1): cv2.COLOR_BayerRG2RGB,
    }
    return cv2.cvtColor(np.ascontiguousarray(raw), codes[odd])
