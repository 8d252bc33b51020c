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

from proxnav.datasets.set import coco
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.types import Image, Mask, Points
from proxnav.images.codecs import read_image
from proxnav.records import FrameLabel, SceneSpec
from proxnav.storage.files import inside, read_json
from proxnav.storage.numbers import finite_numbers

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
        return Camera.from_speed_json(self.folder / "camera.json")

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
    def keypoints_m(self) -> Points:
        """Keypoints in the target frame [m]."""
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

    @property
    def image_paths(self) -> list[Path]:
        """The image files in the order of the labels; InputError for a name that leads out of the set."""
        return [inside(self.folder / "images", label.filename) for label in self.labels]

    def image(self, index: int) -> Image:
        """Image `index` as stored."""
        return read_image(inside(self.folder / "images", self.labels[index].filename))

    def mask(self, index: int) -> Mask:
        """Where the target is in image `index`; masks are PNG whatever the images are."""
        name = Path(self.labels[index].filename).with_suffix(".png")
        return read_image(inside(self.folder / "masks", str(name))) > 127
