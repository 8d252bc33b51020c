"""From an image to keypoints, whatever runs the network: torch or ONNX Runtime."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float, Shaped, UInt8

from proxnav.detection.keypoint_rcnn.decode import Calibration, covariances, decode_maps
from proxnav.detection.keypoint_rcnn.masks import paste
from proxnav.detection.keypoint_rcnn.views import whole
from proxnav.errors import InputError
from proxnav.images.crop import Crop, cut
from proxnav.images.tones import grey_8_bit
from proxnav.records import Keypoints

ZOOM_MARGIN = 1.4
"""Side of the second pass's crop over the longer side of the box found by the first."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """The network's best box in its square input; pixels are those of the input."""

    box_xyxy: Float[np.ndarray, "4"]
    score: float
    keypoint_maps: Float[np.ndarray, "n s s"]
    """Logits over the box."""
    mask_map: Float[np.ndarray, "m m"] | None = None
    """Probability of the target over the box."""


RunNetwork = Callable[[UInt8[np.ndarray, "side side"]], Found]


@dataclass(frozen=True)
class DetectConfig:
    """How the network's answer is read."""

    min_score: float = 0.5
    """Least score of the box; below it there is no target."""
    passes: int = 1
    """2 crops the square round the first box from the full-resolution image and detects once more in it."""
    calibration: Calibration = field(default_factory=Calibration)


@dataclass(frozen=True, slots=True, eq=False)
class Detection:
    """Keypoints and, from a network with a mask head, the target's pixels."""

    keypoints: Keypoints
    mask: Bool[np.ndarray, "h w"] | None = None


def detect(
    run: RunNetwork, image: Shaped[np.ndarray, "..."], side: int, n_keypoints: int, config: DetectConfig
) -> Detection:
    """Keypoints of one image (h, w) or (h, w, 3) of 8 or 16 bits, in its own corner-origin pixels."""
    try:
        picture = grey_8_bit(image)
    except InputError:
        return Detection(Keypoints.none("bad_image", n_keypoints))
    view, found = whole(picture), None
    for _ in range(config.passes):
        if found is not None:
            view = Crop.around(view.to_image(found.box_xyxy.reshape(2, 2), side).ravel(), ZOOM_MARGIN)
        found = run(cut(picture, view, side))
        if found.score < config.min_score:
            return Detection(Keypoints.none("no_target", n_keypoints))
    assert found is not None
    return _in_image(found, view, side, picture.shape, config.calibration)


def _in_image(found: Found, view: Crop, side: int, shape: tuple[int, ...], calibration: Calibration) -> Detection:
    points, spread, scores = decode_maps(found.keypoint_maps, found.box_xyxy)
    box = view.to_image(found.box_xyxy.reshape(2, 2), side).ravel()
    keypoints = Keypoints(
        "ok",
        view.to_image(points, side),
        covariances(spread, view.size / side, calibration),
        scores * found.score,
        box,
    )
    mask = None if found.mask_map is None else paste(found.mask_map, box, (shape[0], shape[1]))
    return Detection(keypoints, mask)
