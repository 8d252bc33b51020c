"""YOLO-pose sets of anyone, read: what `yolo_pose` describes, with or without our files beside it."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from jaxtyping import Float

from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.datasets.formats.names import checked_name, is_name
from proxnav.datasets.formats.options import ReadOptions
from proxnav.datasets.formats.places import camera_above, existing, mask_beside
from proxnav.datasets.formats.row_numbers import numbers
from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses
from proxnav.datasets.formats.yolo_pose import PARTS, POINTS, POSES, YAML
from proxnav.errors import InputError
from proxnav.images.codecs import image_size
from proxnav.storage.files import inside
from proxnav.targets.keypoints.point_files import load_points

_LARGEST_YAML = 2**20
_TOLERANCE = 0.01  # of the loaders that train
_BOX = 5  # class and box come before the keypoints


def is_yolo_pose(path: Path) -> bool:
    """Whether a file is the data.yaml of a pose set."""
    if not path.is_file() or path.stat().st_size > _LARGEST_YAML:
        return False
    return b"kpt_shape" in path.read_bytes()


def read(path: Path, options: ReadOptions) -> Labels:
    """A folder with data.yaml, or the file itself; images need not be there where the camera tells their size."""
    path = path / YAML if path.is_dir() else path
    try:
        content = _content(path)
        shape = [int(n) for n in content["kpt_shape"]]
        if len(shape) != 2 or shape[1] not in (2, 3):
            raise InputError(f"{path}: kpt_shape {shape} is not [keypoints, 2 or 3]")
        root = _root(path, content)
        names, target = _names(content, options.object_id or 0), _class_name(content, options.object_id or 0)
        camera = options.camera or camera_above(root, levels=0)
        poses = read_poses(root / POSES) if (root / POSES).is_file() else {}
        records = [_record(image, part, shape, options, camera, poses) for image, part in _images(root, content, path)]
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, IndexError, OverflowError) as error:
        raise InputError(f"{path}: not a YOLO-pose set ({type(error).__name__}: {str(error)[:80]!a})") from None
    points = options.keypoints_m
    if points is None and (root / POINTS).is_file():
        points, own = load_points(root / POINTS)
        names = names or own
    return Labels(tuple(records), camera, points, names or options.keypoint_names, target, "yolo-pose")


def _content(path: Path) -> Any:
    if not is_yolo_pose(path):
        raise InputError(f"{path}: no YOLO-pose set, it has no kpt_shape; boxes alone are not enough")
    try:
        return yaml.SafeLoader(path.read_bytes()).get_single_data()
    except (yaml.YAMLError, RecursionError, ValueError) as error:
        raise InputError(f"{path}: not readable as YAML ({str(error).splitlines()[0]})") from None


def _root(path: Path, content: Any) -> Path:
    """The folder that `path:` names below the file's own, else the file's own."""
    own = path.resolve().parent
    named = (own / str(content.get("path") or ".")).resolve()
    return named if named.is_dir() and named.is_relative_to(own) else own


def _names(content: Any, which: int) -> tuple[str, ...]:
    found = (content.get("kpt_names") or {}).get(which)
    return (
        tuple(str(name) for name in found) if isinstance(found, list) and len(found) == content["kpt_shape"][0] else ()
    )


def _class_name(content: Any, which: int) -> str:
    names = content.get("names") or {}
    named = dict(enumerate(names)) if isinstance(names, list) else names
    return str(named.get(which, "target"))


def _images(root: Path, content: Any, path: Path) -> Iterator[tuple[Path, str]]:
    """(image, our word for its part) of every part; an image of two parts counts for the first."""
    seen: set[Path] = set()
    for word, ours in PARTS.items():
        entries = content.get(word) or []
        for entry in [entries] if isinstance(entries, str) else entries:
            for image in _listed(root, str(entry), path):
                if image not in seen:
                    seen.add(image)
                    yield image, ours


def _listed(root: Path, entry: str, path: Path) -> list[Path]:
    """The images of a folder, of a list in a .txt, or those whose labels alone are there."""
    place = inside(root, entry)
    if place.is_dir():
        return sorted(p for p in place.rglob("*") if is_name(p.name))
    if place.is_file():
        lines = [line.strip() for line in place.read_text(encoding="utf-8", errors="replace").splitlines()]
        return [inside(root, checked_name(line, str(place))) for line in lines if line]
    labels = _beside(place / "x.png", "labels", "").parent
    if labels.is_dir():
        found = sorted(labels.rglob("*.txt"))
        return [place / label.relative_to(labels).with_suffix(".png") for label in found]
    raise InputError(f"{path}: '{entry}' is no folder or list of images below {root}; check the paths in it")


def _beside(image: Path, kind: str, suffix: str) -> Path:
    """The last folder named images on the way replaced, as the loaders do it."""
    parts = list(image.parts)
    at = max((k for k, part in enumerate(parts[:-1]) if part == "images"), default=None)
    if at is not None:
        parts[at] = kind
    return Path(*parts).with_suffix(suffix)


def _record(
    image: Path, part: str, shape: list[int], options: ReadOptions, camera: Any, poses: dict[str, PoseRecord]
) -> LabelRecord:
    parts = image.parts
    at = max((k for k, word in enumerate(parts[:-1]) if word == "images"), default=len(parts) - 2)
    below = parts[at + 2 :] if len(parts) > at + 2 else parts[-1:]  # images/train/NAME
    name, label = checked_name("/".join(below), str(image)), _beside(image, "labels", ".txt")
    known = poses.get(name)
    file = existing(image.parent, image.name)
    row = _row(label, shape, options.object_id)
    mask = _beside(image, "masks", ".png")
    record = LabelRecord(
        name, None if known is None else known.T_cam_target, "no_pose" if known is None else known.status, part,
        image=file, mask=mask_beside(mask.parent, mask.name), size_px=_size(file, camera, label),
    )  # fmt: skip
    return record if row is None else _with_row(record, row, shape[1], options.pixel_origin)


def _size(image: Path | None, camera: Any, label: Path) -> tuple[int, int]:
    if image is not None:
        return image_size(image)
    if camera is None:
        raise InputError(f"{label}: numbers are parts of the image's size, and the image is not there; give --camera")
    return camera.width, camera.height


def _row(label: Path, shape: list[int], wanted: int | None) -> Float[np.ndarray, "columns"] | None:
    """The numbers of the one object; None where there is none."""
    if not label.is_file():
        return None
    rows = [line.split() for line in label.read_text(encoding="utf-8-sig", errors="replace").splitlines()]
    rows, width = [row for row in rows if row], _BOX + shape[0] * shape[1]
    for number, row in enumerate(rows, 1):
        if len(row) != width:
            raise InputError(
                f"{label}, line {number}: expected {width} numbers (class, box, {shape[0]} keypoints of {shape[1]}), "
                f"found {len(row)}"
            )
    found = [numbers(row, f"{label}, line {number}") for number, row in enumerate(rows, 1)]
    found = [row for row in found if wanted is None or row[0] == wanted]
    if len(found) > 1:
        classes = ", ".join(f"{c:g}" for c in sorted({row[0] for row in found}))
        raise InputError(f"{label}: {len(found)} objects of class {classes}; an image may show one, see --object-id")
    if found and (found[0][1:].min() < -_TOLERANCE or _parts(found[0], shape).max() > 1.0 + _TOLERANCE):
        raise InputError(f"{label}: box and keypoints are parts of the image, 0 to 1; these look like pixels")
    return found[0] if found else None


def _parts(row: Float[np.ndarray, "columns"], shape: list[int]) -> Float[np.ndarray, "n"]:
    """The numbers that are parts of the image's size."""
    return np.concatenate([row[1:_BOX], row[_BOX:].reshape(shape)[:, :2].ravel()])


def _with_row(record: LabelRecord, row: Float[np.ndarray, "columns"], ndim: int, origin: str | None) -> LabelRecord:
    assert record.size_px is not None
    size, points = np.array(record.size_px, dtype=np.float64), row[_BOX:].reshape(-1, ndim)
    flags = points[:, 2] if ndim == 3 else np.where((points == 0.0).all(axis=1), 0.0, 2.0)
    if not np.isin(flags, (0.0, 1.0, 2.0)).all():
        raise InputError(f"'{record.filename}': a keypoint's flag is 0, 1 or 2; found {flags.tolist()}")
    shift = 0.5 if origin == "centre" else 0.0
    pixels = np.where((flags > 0.0)[:, None], points[:, :2] * size + shift, np.nan)
    low, high = (row[1:3] - row[3:5] / 2.0) * size, (row[1:3] + row[3:5] / 2.0) * size
    box = np.concatenate([low, high]) if (high > low).all() else None
    return replace(record, keypoints_px=pixels, visibility=flags.astype(np.int64), box_xyxy=box)
