"""A data set on disk: images, masks, annotations, camera, target, and the scenes that any frame can be redrawn from.

annotations.json   COCO keypoints with poses        camera.json    SPEED+ camera
images/*.png       what the sensor read             target.json    keypoints of the target
masks/*.png        255 where the target is          scenes.jsonl   one SceneSpec a line
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import cv2
import numpy as np

from proxnav.datasets.set import coco
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.images.size import check_claimed_size
from proxnav.records import FrameLabel, SceneSpec
from proxnav.storage.files import inside, read_json
from proxnav.storage.numbers import finite_numbers

MAX_IMAGE_BYTES = 2**29
MAX_LINE_BYTES = 2**20


@dataclass(frozen=True)
class Dataset:
    """A finished data set folder; images and masks are read when asked for."""

    folder: Path

    def __post_init__(self) -> None:
        if not (self.folder / "annotations.json").is_file():
            raise InputError(f"{self.folder}: no annotations.json; not a finished data set (run the same render again)")

    def __len__(self) -> int:
        return len(self.labels)

    @cached_property
    def camera(self) -> Camera:
        """The camera of every image."""
        return Camera.from_speed_json(str(self.folder / "camera.json"))

    @cached_property
    def _annotations(self) -> tuple[tuple[str, ...], list[FrameLabel]]:
        path = self.folder / "annotations.json"
        return coco.parse(read_json(path, "COCO keypoint annotations"), str(path))

    @property
    def keypoint_names(self) -> tuple[str, ...]:
        """Names in label order."""
        return self._annotations[0]

    @property
    def labels(self) -> list[FrameLabel]:
        """Truth of every image, in file order."""
        return self._annotations[1]

    @cached_property
    def keypoints_m(self) -> np.ndarray:
        """(n, 3) keypoints in the target frame [m]."""
        points = finite_numbers(self._target("keypoints_m"), None, f"{self.folder / 'target.json'}: keypoints_m")
        if points.size != 3 * len(self.keypoint_names):
            raise InputError(
                f"{self.folder / 'target.json'}: {points.size / 3:g} keypoints, annotations.json names "
                f"{len(self.keypoint_names)}; both must be of the same target"
            )
        return points.reshape(-1, 3)

    @property
    def target_name(self) -> str:
        """Name of the target that the set shows."""
        return str(self._target("name"))

    def _target(self, key: str) -> Any:
        path = self.folder / "target.json"
        content = read_json(path, "the target's keypoints")
        if not isinstance(content, dict) or key not in content:
            raise InputError(f"{path}: no '{key}'; it should hold the target's name and keypoints")
        return content[key]

    def scenes(self) -> Iterator[SceneSpec]:
        """The scenes of `scenes.jsonl`."""
        path = self.folder / "scenes.jsonl"
        if not path.is_file():
            raise InputError(f"{path}: no such file; only sets that proxnav rendered can be drawn again")
        with path.open("rb") as file:
            for number, line in enumerate(iter(partial(file.readline, MAX_LINE_BYTES), b""), 1):
                try:
                    yield SceneSpec.from_json(json.loads(line))
                except ValueError as error:
                    raise InputError(f"{path}, line {number}: {error}") from None

    def image(self, index: int) -> np.ndarray:
        """Image `index` as stored: uint8 or uint16, grey (h, w) or colour (h, w, 3) in RGB order."""
        return read_image(inside(self.folder / "images", self.labels[index].filename))

    def mask(self, index: int) -> np.ndarray:
        """(h, w) bool, where the target is; masks are PNG whatever the images are."""
        name = Path(self.labels[index].filename).with_suffix(".png")
        return read_image(inside(self.folder / "masks", str(name))) > 127


def read_image(path: Path) -> np.ndarray:
    """An image file as uint8 or uint16, grey or RGB; InputError when it cannot be decoded."""
    return decode_image(read_image_file(path), str(path))


def read_image_file(path: Path) -> bytes:
    """The bytes of an image file; InputError where there is none or it is larger than any image of a camera."""
    if not path.is_file():
        raise InputError(f"{path}: no such image")
    if path.stat().st_size > MAX_IMAGE_BYTES:
        raise InputError(f"{path}: larger than {MAX_IMAGE_BYTES // 2**20} MiB, which no image of a camera is")
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: not readable ({error.strerror}); check its permissions") from None


def decode_image(content: bytes, where: str) -> np.ndarray:
    """The same from the bytes of a file, which messages call `where`."""
    check_claimed_size(content, where)
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


def encode_png(image: np.ndarray) -> bytes:
    """PNG bytes of a grey or RGB uint8/uint16 image; the same array gives the same bytes."""
    pixels = image[..., ::-1] if image.ndim == 3 else image
    ok, encoded = cv2.imencode(".png", np.ascontiguousarray(pixels), _PNG)
    if not ok:
        raise InputError(f"cannot write an array of {image.dtype} and shape {image.shape} as PNG")
    return encoded.tobytes()
