"""What files leave open and the user may say."""

from dataclasses import dataclass
from typing import Literal

from proxnav.datasets.formats.attitude import Order
from proxnav.geometry import Camera
from proxnav.geometry.types import Points
from proxnav.targets import Target


@dataclass(frozen=True, slots=True, eq=False)
class ReadOptions:
    """None leaves it to the file; what the user says wins."""

    camera: Camera | None = None
    keypoints_m: Points | None = None
    """Points of the target, target frame, for files that hold none."""
    keypoint_names: tuple[str, ...] = ()
    quaternion_order: Order | None = None
    """Where the file departs from its format."""
    pixel_origin: Literal["corner", "centre"] | None = None
    """Origin of COCO files that do not say it: pixel (0, 0) is the first pixel's corner, or its centre."""
    object_id: int | None = None
    """Which object, where images show several."""


@dataclass(frozen=True, slots=True, eq=False)
class WriteOptions:
    """How a data set is laid out."""

    images: Literal["link", "copy", "none"] = "link"
    """Hard links share the bytes on one disk; where that fails the image is copied."""
    split: str = ""
    """Name of the part for images that are in none, such as `lightbox`."""
    validation_share: float = 0.2
    """SPEED+, KRN, SPNv2 and URSO: part of an undivided set that goes into validation, every k-th image."""
    bop_images: Literal["auto", "rgb", "gray"] = "auto"
    """BOP: folder of the images; auto takes gray for images of one channel. In rgb they get three."""
    target: Target | None = None
    """BOP: the mesh for `models/`; without it the models' extents are those of the keypoints."""
