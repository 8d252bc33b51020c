"""SPEED, SPEED+ and SHIRT: lists of {filename, q_vbs2tango[_true] (wxyz), r_Vo2To_vbs_true [m]} beside their images.

SPEED    speed/{train,...}.json, images/{train,...}/*.jpg; key q_vbs2tango; camera fixed
SPEED+   {synthetic,lightbox,sunlamp}/{images/, masks/, *.json}, camera.json, key q_vbs2tango_true
SHIRT    trajectory/domain/{images/, *.json}, as SPEED+; SPIN and SHIRT exports wrap the list in {"poses": []}
"""

from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.datasets.formats.labels import LabelRecord, Labels, need_camera, need_pose
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import (
    camera_above,
    existing,
    flat_names,
    mask_beside,
    place,
    training_splits,
    write_camera,
)
from proxnav.datasets.formats.speed_poses import POSITION_KEY, QUATERNION_KEYS, PoseRecord, read_poses, write_poses
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.storage.files import read_json, write_json
from proxnav.targets.keypoints.point_files import load_points

SPEED_CAMERA = Camera(1920, 1200, 0.0176 / 5.86e-6, 0.0176 / 5.86e-6, 960.0, 600.0)
"""Camera of SPEED (2019), which ships no camera file."""

_MAX_FILES = 200


def is_pose_list(content: Any) -> bool:
    """Whether JSON content looks like SPEED records, bare or under `poses`."""
    if isinstance(content, dict):
        content = content.get("poses")
    if not isinstance(content, list):
        return False
    return not content or (isinstance(content[0], dict) and any(key in content[0] for key in QUATERNION_KEYS))


def read_file(path: Path, options: ReadOptions, split: str = "") -> Labels:
    """One JSON file of records, with the images and the camera that lie beside it."""
    records = [_record(entry, path, split, options) for entry in read_poses(path).values()]
    camera = options.camera or camera_above(path.parent)
    return Labels(tuple(records), camera, options.keypoints_m, options.keypoint_names, format="speed+")


def read_tree(folder: Path, options: ReadOptions) -> Labels:
    """All pose lists of a tree, each as its own split."""
    records: list[LabelRecord] = []
    for path in pose_files(folder):
        split = path.relative_to(folder).with_suffix("").as_posix()
        records += read_file(path, options, split).records
    points = options.keypoints_m
    if points is None and (folder / "tangoPoints.mat").is_file():
        points = load_points(folder / "tangoPoints.mat")[0]
    is_speed = (folder / "images" / "train").is_dir()
    camera = options.camera or camera_above(folder) or (SPEED_CAMERA if is_speed else None)
    return Labels(tuple(records), camera, points, options.keypoint_names, format="speed" if is_speed else "speed+")


def pose_files(folder: Path) -> list[Path]:
    """Pose lists up to three folders deep, sorted."""
    paths = [path for depth in ("*", "*/*", "*/*/*") for path in sorted(folder.glob(f"{depth}.json"))]
    if len(paths) > _MAX_FILES:
        raise InputError(f"{folder}: {len(paths)} JSON files; give one file or one folder of a SPEED+ data set")
    return [path for path in paths if is_pose_list(read_json(path, "SPEED records"))]


def write_speedplus(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """The tree of SPEED+, and tangoPoints.mat with the target's points where they are known."""
    write_camera(need_camera(labels, "speed+"), folder)
    groups: dict[str, list[dict[str, Any]]] = defaultdict(list, {"synthetic/train": [], "synthetic/validation": []})
    splits = training_splits(labels, options)
    for record, name, (domain, stem) in zip(labels.records, flat_names(labels.records), splits, strict=True):
        groups[f"{domain}/{stem}"].append(_entry(record, name, QUATERNION_KEYS[0], "speed+"))
        place(record.image, folder / domain / "images" / name, options)
        place(record.mask, folder / domain / "masks" / Path(name).with_suffix(".png"), options)
    for split, entries in groups.items():
        write_json(folder / f"{split}.json", entries, indent=1)
    _write_points(labels, folder)


def write_speed(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """The tree of SPEED (2019); camera.json besides, because the format has no place for a camera."""
    write_camera(labels.camera, folder)
    groups: dict[str, list[dict[str, Any]]] = defaultdict(list, {"train": []})
    for record, name in zip(labels.records, flat_names(labels.records), strict=True):
        split = record.split if record.split in ("train", "test", "real", "real_test") else "train"
        groups[split].append(_entry(record, name, QUATERNION_KEYS[1], "speed"))
        place(record.image, folder / "images" / split / name, options)
    for split, entries in groups.items():
        write_json(folder / f"{split}.json", entries, indent=1)


def write_poses_json(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """`poses.json`: SPEED+ keys with status and covariance, no images."""
    names = flat_names(labels.records)
    records = zip(labels.records, names, strict=True)
    write_poses(folder / "poses.json", [PoseRecord(n, r.T_cam_target, r.status, r.covariance) for r, n in records])
    write_camera(labels.camera, folder)


def _record(entry: PoseRecord, path: Path, split: str, options: ReadOptions) -> LabelRecord:
    name = checked_name(entry.filename, str(path))
    images = path.parent / "images"
    own = images / path.stem
    T = entry.T_cam_target
    if T is not None and options.quaternion_order == "xyzw":
        T = Pose.from_wxyz("cam", "target", np.roll(T.q_wxyz, 1), T.t_m)
    return LabelRecord(
        name, T, entry.status, split, covariance=entry.covariance,
        image=existing(own if own.is_dir() else images, name), mask=mask_beside(path.parent / "masks", name),
    )  # fmt: skip


def _entry(record: LabelRecord, name: str, key: str, format: str) -> dict[str, Any]:
    T = need_pose(record, format)
    return {"filename": name, key: quaternion.canonical(T.q_wxyz).tolist(), POSITION_KEY: T.t_m.tolist()}


def _write_points(labels: Labels, folder: Path) -> None:
    from scipy.io import savemat

    if labels.keypoints_m is not None:
        savemat(folder / "tangoPoints.mat", {"tango3Dpoints": labels.keypoints_m.T})


def with_split(labels: Labels, split: str) -> Labels:
    """The same labels with `split` wherever a record has none."""
    return replace(labels, records=tuple(r if r.split else replace(r, split=split) for r in labels.records))
