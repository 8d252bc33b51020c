"""Images in files: any of 8 or 16 bits in, PNG and JPEG out; colour is RGB."""

from pathlib import Path

import cv2
import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.types import Image
from proxnav.images.size import claimed_size

MAX_BYTES = 2**29
_HEADER_BYTES = 2**20  # notes of cameras may stand before a JPEG's size


def read_image(path: Path) -> Image:
    """An image file as uint8 or uint16, grey or RGB; InputError when it cannot be decoded."""
    return decode_image(read_image_file(path), str(path))


def read_image_file(path: Path) -> bytes:
    """The bytes of an image file; InputError where there is none or it is larger than any image of a camera."""
    if not path.is_file():
        raise InputError(f"{path}: no such image")
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path}: larger than {MAX_BYTES // 2**20} MiB, which no image of a camera is")
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: not readable ({error.strerror}); check its permissions") from None


def image_size(path: Path) -> tuple[int, int]:
    """(width, height) of an image file [px], which is not decoded for it."""
    if not path.is_file():
        raise InputError(f"{path}: no such image")
    with path.open("rb") as file:
        return claimed_size(file.read(_HEADER_BYTES), str(path))


def decode_image(content: bytes, where: str) -> Image:
    """The same from the bytes of a file, which messages call `where`."""
    claimed_size(content, where)
    try:
        image = cv2.imdecode(np.frombuffer(content, np.uint8), cv2.IMREAD_UNCHANGED)
    except cv2.error:
        image = None
    if image is None:
        raise InputError(f"{where}: not a readable image; it is damaged")
    if image.dtype not in (np.uint8, np.uint16):
        raise InputError(f"{where}: holds {image.dtype} pixels; expected an image of 8 or 16 bits")
    if image.ndim == 3:
        image = np.ascontiguousarray(image[..., 2::-1])
    return image


_PNG = [cv2.IMWRITE_PNG_COMPRESSION, 1, cv2.IMWRITE_PNG_STRATEGY, cv2.IMWRITE_PNG_STRATEGY_RLE]
"""Runs only: of sensor noise nothing else can be found, at half the time and five sixths of the bytes of level 3."""


def encode_png(image: Image) -> bytes:
    """PNG bytes of a grey or RGB uint8/uint16 image; the same array gives the same bytes."""
    return _encoded(".png", image, _PNG)


def encode_jpeg(image: Image, quality: int) -> bytes:
    """JPEG bytes of a grey or RGB uint8 image; `quality` is 0 to 100."""
    return _encoded(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])


def _encoded(kind: str, image: Image, settings: list[int]) -> bytes:
    pixels = image[..., ::-1] if image.ndim == 3 else image
    ok, encoded = cv2.imencode(kind, np.ascontiguousarray(pixels), settings)
    if not ok:
        raise InputError(f"cannot write an array of {image.dtype} and shape {image.shape} as {kind}")
    return encoded.tobytes()
