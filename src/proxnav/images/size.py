"""Sizes of images: what the first bytes of a file claim (a hundred bytes may claim gigabytes), and the camera's."""

import re
import struct

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import Image

LARGEST_SIDE_PX = 32_768
MOST_PIXELS = 2**28
_PNM = re.compile(rb"P[1-6](?:\s|#[^\n]*\n)+(\d{1,9})(?:\s|#[^\n]*\n)+(\d{1,9})\s")
_NO_FRAME = {0xC4, 0xC8, 0xCC}


def claimed_size(content: bytes, where: str) -> tuple[int, int]:
    """(width, height) [px] as the file's first bytes claim; InputError for what is no PNG, JPEG, TIFF, BMP or PNM, or
    claims more pixels than any camera has.
    """
    size = _claimed(content)
    if size is None:
        raise InputError(f"{where}: not a readable image; it is damaged, or no PNG, JPEG, TIFF, BMP or PNM")
    width, height = size
    if not (0 < width <= LARGEST_SIDE_PX and 0 < height <= LARGEST_SIDE_PX and width * height <= MOST_PIXELS):
        raise InputError(
            f"{where}: claims {width} x {height} px; read are at most {LARGEST_SIDE_PX} px a side, {MOST_PIXELS} in all"
        )
    return size


def check_size(image: Image, camera: Camera) -> None:
    """InputError when the image is not of the camera's size."""
    height, width = image.shape[:2]
    if (width, height) != (camera.width, camera.height):
        raise InputError(
            f"the image is {width}x{height} px, the camera {camera.width}x{camera.height} px; "
            "give the camera.json of these images or resize the camera with them"
        )


def _claimed(content: bytes) -> tuple[int, int] | None:
    """(width, height), None where there is no such header."""
    try:
        if content[:8] == b"\x89PNG\r\n\x1a\n" and content[12:16] == b"IHDR":
            return struct.unpack(">2I", content[16:24])
        if content[:2] == b"\xff\xd8":
            return _jpeg(content)
        if content[:4] in (b"II*\0", b"MM\0*"):
            return _tiff(content)
        if content[:2] == b"BM":
            width, height = struct.unpack("<2i", content[18:26])
            return abs(width), abs(height)
    except (struct.error, IndexError):
        return None
    match = _PNM.match(content)
    return None if match is None else (int(match[1]), int(match[2]))


def _jpeg(content: bytes) -> tuple[int, int] | None:
    """The largest frame of the segments before the picture: a second header must not slip past the first."""
    place, found = 2, None
    while place + 9 <= len(content):
        if content[place] != 0xFF:
            return found
        marker = content[place + 1]
        if marker == 0xDA:
            return found
        if marker == 0xFF or 0xD0 <= marker <= 0xD8 or marker == 0x01:
            place += 1 if marker == 0xFF else 2
            continue
        if 0xC0 <= marker <= 0xCF and marker not in _NO_FRAME:
            height, width = struct.unpack(">2H", content[place + 5 : place + 9])
            found = max(found or (0, 0), (width, height), key=lambda one: one[0] * one[1])
        place += 2 + struct.unpack(">H", content[place + 2 : place + 4])[0]
    return found


def _tiff(content: bytes) -> tuple[int, int] | None:
    """Size in the first directory."""
    order = "<" if content[:2] == b"II" else ">"
    (start,) = struct.unpack(f"{order}I", content[4:8])
    (count,) = struct.unpack(f"{order}H", content[start : start + 2])
    sizes: dict[int, int] = {}
    for k in range(count):
        entry = content[start + 2 + 12 * k : start + 14 + 12 * k]
        tag, kind = struct.unpack(f"{order}2H", entry[:4])
        if tag in (256, 257) and kind in (3, 4):
            (sizes[tag],) = struct.unpack(f"{order}{'H' if kind == 3 else 'I'}", entry[8 : 10 if kind == 3 else 12])
    return (sizes[256], sizes[257]) if len(sizes) == 2 else None
