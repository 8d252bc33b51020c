"""What people hand over as image or camera: taken where it can mean one thing only, else refused in a sentence."""

from pathlib import Path
from typing import Any

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import GreyImage, Image

_HINT = "(height, width) or (height, width, 3), uint8 or uint16"


def checked_camera(camera: Any, image: Any = None) -> Camera:
    """`camera` if it is one; InputError names the slip."""
    if isinstance(camera, Camera):
        return camera
    if isinstance(image, Camera):
        raise InputError("image and camera are exchanged: call estimator(image, camera)")
    if isinstance(camera, str | Path):
        raise InputError(f"camera is a path: read it first, Camera.read({str(camera)!r})")
    if isinstance(camera, list | tuple) and camera and isinstance(camera[0], Camera):
        raise InputError("camera is a list of cameras: estimator.batch(images, cameras) takes several")
    if np.shape(camera) == (3, 3):
        raise InputError(
            "camera is a matrix K, which lacks the image's size: give Camera(width, height, fx, fy, cx, cy)"
        )
    raise InputError(f"camera must be a proxnav Camera, found {type(camera).__name__}")


def as_image(given: Any, camera: Camera) -> Image:
    """An image of the camera's size as uint8 or uint16.

    Taken are also paths, PIL images, torch tensors, channels first, and floats in [0, 1]; batches, floats of another
    range, signed and complex numbers are refused.
    """
    from proxnav.images.codecs import read_image  # brings cv2, which a solver of keypoints does without
    from proxnav.images.size import check_size

    is_path = isinstance(given, str | Path)
    image = read_image(Path(given)) if is_path else _counts(_channels_last(_array(given), camera))
    check_size(image, camera)
    return image


def as_grey(given: Any, camera: Camera) -> GreyImage:
    """The same as grey of 8 bits, offsets of its rows and columns taken out: what poses are read from."""
    from proxnav.images.line_offsets import without_line_offsets
    from proxnav.images.tones import grey_8_bit  # brings cv2

    return without_line_offsets(grey_8_bit(as_image(given, camera)))


def _array(given: Any) -> np.ndarray:
    if isinstance(given, Camera):
        raise InputError("image is a Camera: call estimator(image, camera)")
    if hasattr(given, "detach"):  # a torch tensor, wherever it lies
        given = given.detach().cpu().numpy()
    elif hasattr(given, "getbands"):  # a PIL image
        given = given.convert("RGB") if given.mode in ("P", "CMYK", "YCbCr", "HSV", "LAB") else given
    try:
        array = np.asarray(given)
    except (TypeError, ValueError):
        array = np.empty(0, dtype=object)
    if array.dtype.kind not in "uifb":
        raise InputError(f"an image must be an array {_HINT}; found {type(given).__name__}")
    return array


def _channels_last(array: np.ndarray, camera: Camera) -> np.ndarray:
    """(height, width[, channels]) of the same, where the shape can be read in one way only."""
    size = (camera.height, camera.width)
    while array.ndim > 3 and array.shape[0] == 1:
        array = array[0]
    if array.ndim == 3 and array.shape[0] in (1, 3, 4) and array.shape[1:] == size and array.shape[:2] != size:
        array = np.moveaxis(array, 0, -1)
    if array.ndim == 4 or (array.ndim == 3 and array.shape[1:] == size and array.shape[:2] != size):
        raise InputError(f"found a batch of shape {array.shape}: estimator.batch(images, cameras) takes several images")
    if array.ndim not in (2, 3) or 0 in array.shape or (array.ndim == 3 and array.shape[2] not in (1, 3, 4)):
        raise InputError(f"an image must be {_HINT}; found shape {array.shape}")
    return np.ascontiguousarray(array)


def _counts(array: np.ndarray) -> Image:
    """The same as uint8 or uint16; floats in [0, 1] as parts of 255."""
    if array.dtype in (np.uint8, np.uint16):
        return array
    if array.dtype.kind == "f":
        low, high = float(array.min()), float(array.max())
        if low >= 0.0 and high <= 1.0:
            return np.rint(array * 255.0).astype(np.uint8)
        raise InputError(
            f"a float image must lie in [0, 1], found {low:.4g} to {high:.4g}; undo its normalisation, or convert it "
            "to uint8 or uint16"
        )
    if array.dtype.kind == "i" and array.min() >= 0 and array.max() <= 65535:
        return array.astype(np.uint8 if array.max() <= 255 else np.uint16)
    raise InputError(f"an image must be {_HINT}; found {array.dtype}")
