"""What the network is given of an image: a square of it, grey, at the network's side."""

import numpy as np
from jaxtyping import Float

from proxnav.detection.samples import TrainingSample
from proxnav.geometry.types import GreyImage
from proxnav.images.crop import Crop, cut
from proxnav.images.tones import grey_8_bit


def whole(image: GreyImage) -> Crop:
    """The square that holds the whole image, from its upper left corner."""
    return Crop(0, 0, max(image.shape[:2]))


def zoomed(box_xyxy: Float[np.ndarray, "4"], rng: np.random.Generator) -> Crop:
    """A square around the box with a random margin and offset."""
    size = box_xyxy[2:] - box_xyxy[:2]
    moved = box_xyxy + np.tile(rng.uniform(-0.1, 0.1, 2) * size.max(), 2)
    return Crop.around(moved, margin=rng.uniform(1.15, 2.0))


def in_view(sample: TrainingSample, view: Crop, side: int) -> TrainingSample:
    """The sample as the network is given it; points and box beyond the view are cut off."""
    points = view.to_network(sample.keypoints_px, side)
    inside = ((points >= 0) & (points < side)).all(axis=1)
    corners = view.to_network(sample.box_xyxy.reshape(2, 2), side)
    box = np.clip(corners, 0.0, side).ravel()
    mask = None if sample.mask is None else cut(sample.mask.astype(np.uint8) * 255, view, side) > 127
    image = cut(grey_8_bit(sample.image), view, side)
    return TrainingSample(image, points, np.where(inside, sample.visibility, 0), box, mask)


def padded(box_xyxy: Float[np.ndarray, "4"], share: float, side: int) -> Float[np.ndarray, "4"]:
    """The box grown by `share` of its width and height on every side, within the view."""
    size = np.tile(box_xyxy[2:] - box_xyxy[:2], 2)
    return np.clip(box_xyxy + np.array([-1.0, -1.0, 1.0, 1.0]) * share * size, 0.0, side)
