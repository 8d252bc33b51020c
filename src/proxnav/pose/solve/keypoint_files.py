"""Keypoints of somebody else's detector, as COCO keypoint results.

A file is a list of {image_id or file_name, keypoints: [x, y, score] * n, score?, covariances_px2?}, or a COCO document
with `images` and `annotations`. Points not found have score 0 or are null. Of several detections in one image
the one with the largest `score` counts.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.arrays import frozen
from proxnav.storage.files import read_json

_EXPECTED = "COCO keypoint results: a list of objects with image_id or file_name, and keypoints [x, y, score] * n"
PixelOrigin = Literal["corner", "centre"]


@dataclass(frozen=True, slots=True, eq=False)
class KeypointRecord:
    """The keypoints of one image, corner origin."""

    filename: str
    pixels: Float[np.ndarray, "n 2"]
    """NaN where not found [px]."""
    scores: Float[np.ndarray, "n"]
    covariances_px2: Float[np.ndarray, "n 2 2"] | None
    """Where the file has them [px^2]."""
    score: float
    """Score of the detection as a whole."""

    def __post_init__(self) -> None:
        n = len(self.pixels)
        object.__setattr__(self, "pixels", frozen(self.pixels, (n, 2), "pixels"))
        object.__setattr__(self, "scores", frozen(self.scores, (n,), "scores"))
        if self.covariances_px2 is not None:
            object.__setattr__(self, "covariances_px2", frozen(self.covariances_px2, (n, 2, 2), "covariances_px2"))


def read_keypoints(path: Path, origin: PixelOrigin = "corner") -> tuple[KeypointRecord, ...]:
    """One record per image, in file order; `origin` is where the file's pixel (0, 0) lies: at the corner of the first
    pixel (our rule) or at its centre (OpenCV and most COCO detectors). InputError names the entry at fault.
    """
    content = read_json(path, _EXPECTED)
    names: dict[Any, str] = {}
    if isinstance(content, dict) and isinstance(content.get("annotations"), list):
        names = _image_names(content, path)
        content = content["annotations"]
    if not isinstance(content, list):
        raise InputError(f"{path}: expected {_EXPECTED}, found one {type(content).__name__}")
    shift = 0.5 if origin == "centre" else 0.0
    best: dict[str, KeypointRecord] = {}
    for number, entry in enumerate(content):
        record = _record(entry, names, shift, f"{path}, entry {number}")
        if record.filename not in best or record.score > best[record.filename].score:
            best[record.filename] = record
    if not best:
        raise InputError(f"{path}: holds no keypoints; expected {_EXPECTED}")
    return tuple(best.values())


def _image_names(content: Mapping[str, Any], path: Path) -> dict[Any, str]:
    try:
        return {image["id"]: str(image["file_name"]) for image in content.get("images", [])}
    except (TypeError, KeyError) as error:
        raise InputError(f"{path}: every entry of 'images' needs id and file_name ({error!r})") from None


def _record(entry: Any, names: Mapping[Any, str], shift: float, where: str) -> KeypointRecord:
    if not isinstance(entry, Mapping) or "keypoints" not in entry or not {"image_id", "file_name"} & set(entry):
        found = ", ".join(map(str, entry)) if isinstance(entry, Mapping) else type(entry).__name__
        raise InputError(f"{where}: needs keypoints and image_id or file_name, found {found}")
    filename = str(entry["file_name"]) if "file_name" in entry else _image_name(entry["image_id"], names, where)
    where = f"{where} ({filename})"
    triples = _numbers(entry["keypoints"], where, "keypoints")
    if triples.size == 0 or triples.size % 3:
        raise InputError(f"{where}: keypoints needs [x, y, score] * n, found {triples.size} numbers")
    triples = triples.reshape(-1, 3)
    scores = np.where(np.isnan(triples[:, 2]), 0.0, triples[:, 2])
    covariances = _covariances(entry.get("covariances_px2"), len(triples), where)
    score = entry.get("score")
    whole = float(score) if isinstance(score, int | float) else float(scores.mean())
    return KeypointRecord(filename, triples[:, :2] + shift, scores, covariances, whole)


def _image_name(image_id: Any, names: Mapping[Any, str], where: str) -> str:
    if not isinstance(image_id, int | str):
        raise InputError(f"{where}: image_id must be a number or a name, found {str(image_id)[:60]}")
    return names.get(image_id, str(image_id))


def _covariances(values: Any, n: int, where: str) -> Float[np.ndarray, "n 2 2"] | None:
    if values is None:
        return None
    array = _numbers(values, where, "covariances_px2")
    if array.size != 4 * n:
        raise InputError(
            f"{where}: covariances_px2 needs one 2x2 matrix for each of {n} keypoints, found {array.size} numbers"
        )
    return array.reshape(n, 2, 2)


def _numbers(values: Any, where: str, key: str) -> Float[np.ndarray, "numbers"]:
    try:
        return np.array(values, dtype=np.float64).ravel()
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{where}: {key} must be numbers in rows of equal length, found {str(values)[:60]}") from None
