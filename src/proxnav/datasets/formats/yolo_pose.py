"""YOLO-pose: data.yaml with kpt_shape, images/PART/*, labels/PART/*.txt; a line is an object: class, box, keypoints.

Box (centre, size) and keypoints are parts of the image's width and height, corner origin. A keypoint has the flags of
COCO: 2 seen, 1 hidden, 0 not labelled, which is written 0 0 0, for points outside the image as well: the loaders refuse
numbers below 0 or above 1. There is no flip_idx: the mirror image of a craft is no view of it. The format knows neither
poses nor 3-D points nor cameras: they lie beside it in poses.json, keypoints.json and camera.json.
"""

from collections import Counter
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import yaml

from proxnav.datasets.formats.labels import LabelRecord, Labels, need_keypoints, size_of, visibility_of
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import WriteOptions
from proxnav.datasets.formats.places import flat_names, place, training_splits, write_camera
from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.errors import InputError
from proxnav.geometry.boxes import box_of_points
from proxnav.records import NOT_IN_IMAGE
from proxnav.storage.files import write_atomic, write_json

YAML, POSES, POINTS = "data.yaml", "poses.json", "keypoints.json"
PARTS = {"train": "train", "val": "validation", "test": "test"}
"""YOLO's word for a part, and ours."""


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """The set with every image and its label file, and beside it what the format cannot hold."""
    names, theirs = flat_names(labels.records), {ours: word for word, ours in PARTS.items()}
    parts = [theirs[part] for _, part in training_splits(labels, options)]
    _check_stems(names)
    for record, name, part in zip(labels.records, names, parts, strict=True):
        path = PurePosixPath(checked_name(name, "yolo-pose"))
        place(record.image, folder / "images" / part / name, options)
        place(record.mask, folder / "masks" / part / path.with_suffix(".png"), options)
        line = _line(record, labels)
        write_atomic(folder / "labels" / part / path.with_suffix(".txt"), line.encode())
    write_atomic(folder / YAML, _yaml(labels, parts).encode())
    write_camera(labels.camera, folder)
    posed = [PoseRecord(n, r.T_cam_target, r.status) for r, n in zip(labels.records, names, strict=True)]
    if any(record.T_cam_target is not None for record in posed):
        write_poses(folder / POSES, posed)
    if labels.keypoints_m is not None:
        content = {"keypoint_names": list(labels.keypoint_names), "keypoints_m": labels.keypoints_m.tolist()}
        write_json(folder / POINTS, content, indent=1)


def _line(record: LabelRecord, labels: Labels) -> str:
    """The object's line, or nothing where the image shows none."""
    if record.keypoints_px is None and record.T_cam_target is None:
        return ""
    if record.keypoints_px is None:
        need_keypoints(labels, "yolo-pose")
    flags = visibility_of(record, labels, "yolo-pose")
    size = np.array(size_of(record, labels, "yolo-pose"), dtype=np.float64)
    pixels = record.keypoints_px
    assert pixels is not None
    inside = ((pixels >= 0.0) & (pixels <= size)).all(axis=1)
    flags = np.where(inside, flags, NOT_IN_IMAGE)
    box = record.box_xyxy if record.box_xyxy is not None else box_of_points(pixels[flags != NOT_IN_IMAGE])
    low, high = np.clip(box[:2] / size, 0.0, 1.0), np.clip(box[2:] / size, 0.0, 1.0)
    if not (high > low).all():
        return ""
    points = np.where((flags != NOT_IN_IMAGE)[:, None], np.nan_to_num(pixels / size), 0.0)
    triples = [f"{u:.10g} {v:.10g} {flag}" for (u, v), flag in zip(points.tolist(), flags.tolist(), strict=True)]
    return " ".join(["0", *(f"{value:.10g}" for value in (*(low + high) / 2.0, *(high - low))), *triples]) + "\n"


def _yaml(labels: Labels, parts: list[str]) -> str:
    names = list(labels.keypoint_names)
    count = len(names) or next((len(r.keypoints_px) for r in labels.records if r.keypoints_px is not None), 0)
    if count == 0:
        raise InputError("yolo-pose needs keypoints and the source has none; give --target and --camera")
    content: dict[str, Any] = {word: f"images/{word}" for word in PARTS if word in parts}
    first = next(iter(content.values()))
    content = {"train": first, "val": first} | content  # training wants both
    content |= {"kpt_shape": [count, 3], "names": {0: labels.target_name}}
    if names:
        content["kpt_names"] = {0: names}
    note = "# no flip_idx: the mirror image of a craft is no view of it, so training must not flip images\n"
    return note + yaml.safe_dump(content, sort_keys=False)


def _check_stems(names: list[str]) -> None:
    twice, count = Counter(str(PurePosixPath(name).with_suffix("")) for name in names).most_common(1)[0]
    if count > 1:
        raise InputError(f"{count} images are named '{twice}' but for their endings; yolo-pose needs different names")
