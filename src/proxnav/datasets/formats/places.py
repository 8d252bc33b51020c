"""Where images, masks and cameras of a data set lie, and how they get into another."""

import os
import shutil
from collections import Counter
from collections.abc import Sequence
from pathlib import Path, PurePosixPath

from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.datasets.formats.options import WriteOptions
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import speed_json
from proxnav.storage.files import inside, read_json, write_json

_TRAINING = ("train", "validation", "test")
_SYNONYMS = {"val": "validation", "training": "train", "testing": "test"}


def existing(folder: Path, name: str) -> Path | None:
    """`folder/name` if it is a file; InputError when the name climbs out."""
    if not folder.is_dir():
        return None
    path = inside(folder, name)
    return path if path.is_file() else None


def mask_beside(folder: Path, name: str) -> Path | None:
    """The mask of image `name`: the same name, or ending in .png."""
    return existing(folder, name) or existing(folder, str(PurePosixPath(name).with_suffix(".png")))


def camera_above(path: Path, levels: int = 3) -> Camera | None:
    """The camera of the nearest SPEED+ camera.json in `path` (a folder) or the folders above it."""
    for folder in (path, *path.resolve().parents[:levels]):
        if _is_speed_camera(folder / "camera.json"):
            return Camera.from_speed_json(folder / "camera.json")
    return None


def write_camera(camera: Camera | None, folder: Path) -> None:
    """A SPEED+ camera.json, numbers only."""
    if camera is not None:
        write_json(folder / "camera.json", speed_json(camera), indent=1)


def place(source: Path | None, destination: Path, options: WriteOptions) -> None:
    """Links or copies an image; nothing where there is none."""
    if source is None or options.images == "none":
        return
    destination.parent.mkdir(parents=True, exist_ok=True)
    if options.images == "link":
        try:
            os.link(source.resolve(), destination)
            return
        except OSError:  # other disk, or a file system without links
            pass
    shutil.copyfile(source, destination)


def flat_names(records: Sequence[LabelRecord]) -> list[str]:
    """One name per record, unique in the set: the image's own, or with its split before it where names repeat."""
    counts = Counter(record.filename for record in records)
    names = [r.filename if counts[r.filename] == 1 else f"{_joined(r.split)}{r.filename}" for r in records]
    if len(set(names)) != len(names):
        twice = Counter(names).most_common(1)[0][0]
        raise InputError(f"image '{twice}' occurs more than once in the same part of the set; name images differently")
    return names


def training_splits(labels: Labels, options: WriteOptions, domain: str = "synthetic") -> list[tuple[str, str]]:
    """(domain, train | validation | test) of every record; undivided sets are divided by `validation_share`."""
    every = round(1.0 / options.validation_share) if options.validation_share > 0.0 else 0
    found = []
    for index, record in enumerate(labels.records):
        parts = PurePosixPath(record.split or options.split).parts
        last = _SYNONYMS.get(parts[-1], parts[-1]) if parts else ""
        if last in _TRAINING:
            found.append(("/".join(parts[:-1]) or domain, last))
        elif parts and parts[0] in ("lightbox", "sunlamp"):
            found.append((parts[0], "test"))
        else:
            found.append((domain, "validation" if every and index % every == every - 1 else "train"))
    return found


def _is_speed_camera(path: Path) -> bool:
    """Whether the file is a SPEED+ camera and not BOP's or a stranger's of the same name."""
    if not path.is_file():
        return False
    try:
        content = read_json(path, "a camera")
    except InputError:
        return False
    return isinstance(content, dict) and "cameraMatrix" in content


def _joined(split: str) -> str:
    return split.replace("/", "_") + "_" if split else ""
