"""Light that the lens puts where it does not belong: an even veil, and a soft halo about bright things."""

import cv2
import numpy as np

from proxnav.sensor.blur import Image, gaussian

_HALO = ((6.0, 0.7), (24.0, 0.3))  # sigma [px] and share: scatter falls off slower than one Gaussian does


def veil(image: Image, share: float) -> Image:
    """The image with `share` of its mean flux taken from every pixel and spread evenly: flux is conserved."""
    if share <= 0.0:
        return image
    mean = image.mean(axis=(0, 1), dtype=np.float64)
    return (image * (1.0 - share) + mean * share).astype(np.float32)


def halo(image: Image, share: float, pixel_scale: float) -> Image:
    """The image with `share` of each pixel's light spread over a halo of some tens of pixels."""
    if share <= 0.0:
        return image
    spread = sum(part * _wide_gaussian(image, sigma * pixel_scale) for sigma, part in _HALO)
    return (image * (1.0 - share) + spread * share).astype(np.float32)


def _wide_gaussian(image: Image, sigma_px: float) -> Image:
    """Gaussian blur on a grid four times coarser when it is wide: the same to the eye at a tenth of the time."""
    if sigma_px < 5.0 or min(image.shape[:2]) < 16:
        return gaussian(image, sigma_px)
    height, width = image.shape[:2]
    small = cv2.resize(image, (-(-width // 4), -(-height // 4)), interpolation=cv2.INTER_AREA)
    return cv2.resize(gaussian(small, sigma_px / 4.0), (width, height), interpolation=cv2.INTER_LINEAR)
