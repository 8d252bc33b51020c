"""The small mask over a box, laid into the image."""

import cv2
import numpy as np
from jaxtyping import Bool, Float


def paste(
    probability: Float[np.ndarray, "m m"], box_xyxy: Float[np.ndarray, "4"], shape: tuple[int, int]
) -> Bool[np.ndarray, "h w"]:
    """Pixels of an image of `shape` (h, w) whose centre has a probability of one half or more; outside the box none."""
    m = probability.shape[0]
    scale = (box_xyxy[2:] - box_xyxy[:2]) / m
    # warpAffine counts from pixel centres: x_image + 0.5 = x0 + (x_map + 0.5) * scale.
    offset = box_xyxy[:2] + 0.5 * scale - 0.5
    forward = np.array([[scale[0], 0.0, offset[0]], [0.0, scale[1], offset[1]]])
    values = cv2.warpAffine(
        probability.astype(np.float32), forward, shape[::-1], flags=cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE
    )
    x, y = np.arange(shape[1]) + 0.5, np.arange(shape[0]) + 0.5
    inside = ((y >= box_xyxy[1]) & (y < box_xyxy[3]))[:, None] & ((x >= box_xyxy[0]) & (x < box_xyxy[2]))
    return (values >= 0.5) & inside
