"""Writing a data set so that it can be killed at any moment and resumed: a frame is done when its record is there.

While unfinished, the folder holds `.frames/<name>.json`, one annotation per frame, written last of the frame's files.
`finish` gathers them into `annotations.json` and removes the folder, so that an interrupted and resumed set ends with
the same files as an uninterrupted one.
"""

import json
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxnav.datasets.set import coco
from proxnav.errors import InputError
from proxnav.geometry.camera_files import speed_json
from proxnav.geometry.types import Image, Mask
from proxnav.images.codecs import encode_png
from proxnav.records import FrameLabel, SceneSpec
from proxnav.storage.files import cannot_write, json_bytes, read_json, write_atomic, write_json
from proxnav.storage.lock import LOCK
from proxnav.targets import Target

_PENDING = ".frames"


@dataclass(frozen=True)
class DatasetWriter:
    """Writes frames of one data set; safe to use from several processes, each with its own frames."""

    folder: Path

    def begin(self, scenes: Sequence[SceneSpec], target: Target) -> list[SceneSpec]:
        """Writes what all frames share and returns the scenes that are still to be rendered.

        InputError when the folder already holds a data set of other scenes.
        """
        lines = self.check(scenes)
        path = self.folder / "scenes.jsonl"
        if (self.folder / "annotations.json").exists():
            return []
        try:
            for part in ("images", "masks", _PENDING):
                (self.folder / part).mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise cannot_write(self.folder, error) from None
        self._sweep()
        write_json(self.folder / "camera.json", speed_json(scenes[0].camera), indent=1)
        write_json(self.folder / "target.json", _keypoints(target), indent=1)
        write_atomic(path, lines)
        return [scene for scene in scenes if not self._record(scene).exists()]

    def check(self, scenes: Sequence[SceneSpec]) -> bytes:
        """The scenes as lines; InputError where the folder holds anything but a set of just these scenes."""
        lines = "".join(json.dumps(scene.to_json(), allow_nan=False) + "\n" for scene in scenes).encode()
        path = self.folder / "scenes.jsonl"
        if self.folder.exists() and not self.folder.is_dir():
            raise InputError(f"{self.folder} is a file; a data set is a folder, give another --out")
        if path.exists() and path.read_bytes() != lines:
            raise InputError(
                f"{self.folder} holds another data set; resume it with its own options or give another --out"
            )
        if not path.exists() and self.folder.is_dir() and not _begun(self.folder):
            raise InputError(f"{self.folder} is not empty and holds no data set; give another --out")
        return lines

    def add(self, scene: SceneSpec, image: Image, mask: Mask, label: FrameLabel) -> None:
        """One frame: image, mask, then its record."""
        self.put(encode_frame(scene, image, mask, label))

    def put(self, files: Mapping[str, bytes]) -> None:
        """The files of one frame, of whichever process, in their order."""
        for name, content in files.items():
            write_atomic(self.folder / name, content)

    def finish(self, scenes: Sequence[SceneSpec], target: Target) -> Path:
        """Gathers the records of all frames into `annotations.json`; returns the folder."""
        path = self.folder / "annotations.json"
        if not path.exists():
            entries = [read_json(self._record(scene), "the record of a rendered frame") for scene in scenes]
            names = [scene.filename for scene in scenes]
            sizes = [(scene.camera.width, scene.camera.height) for scene in scenes]
            write_json(path, coco.document(entries, names, sizes, target.keypoint_names))
        shutil.rmtree(self.folder / _PENDING, ignore_errors=True)
        return self.folder

    def _record(self, scene: SceneSpec) -> Path:
        return self.folder / _record_name(scene)

    def _sweep(self) -> None:
        """Removes what a killed writer left half-written."""
        for part in (".", "images", "masks", _PENDING):
            for stray in (self.folder / part).glob(".*.part"):
                stray.unlink(missing_ok=True)


def _begun(folder: Path) -> bool:
    """Whether all that lies in a folder without scenes may be of a run that has just begun, or ran out of room."""
    ours = {LOCK, "images", "masks", _PENDING, "camera.json", "target.json"}
    found = {path.name for path in folder.iterdir() if not path.name.endswith(".part")}
    return not found or (found <= ours and (found == {LOCK} or _PENDING in found))


def encode_frame(scene: SceneSpec, image: Image, mask: Mask, label: FrameLabel) -> dict[str, bytes]:
    """The files of one frame by their path in the data set, its record last."""
    return {
        f"images/{scene.filename}": encode_png(image),
        f"masks/{scene.filename}": encode_png(mask.astype(np.uint8) * 255),
        _record_name(scene): json_bytes(coco.annotation(label, mask)),
    }


def _record_name(scene: SceneSpec) -> str:
    return f"{_PENDING}/{Path(scene.filename).stem}.json"


def _keypoints(target: Target) -> dict[str, object]:
    return {
        "name": target.name,
        "keypoint_names": list(target.keypoint_names),
        "keypoints_m": target.keypoints_m.tolist(),
        "subsets": {name: list(index) for name, index in target.subsets.items()},
        "licence": target.licence,
    }
