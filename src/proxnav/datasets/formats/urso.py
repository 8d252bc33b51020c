"""URSO: {train,val,test}_images.csv (one name a row) beside {...}_poses_gt.csv (header x,y,z,q1,q2,q3,q4; q4 scalar).

Axes are Unreal's, left-handed: x forward, y right, z up, for the camera and for the target. UrsoNet draws with the
matrix of the left-handed (JPL) quaternion and u = cx + fx y/x, v = cy - |fy| z/x. With p_target = diag(1, -1, 1) p_urso
(a right-handed target) this is t = (y, -z, x) and q_cam_target = (q4, q1, -q2, q3).
"""

from collections import defaultdict
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.attitude import Order, pose
from proxnav.datasets.formats.labels import LabelRecord, Labels, need_pose
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import (
    camera_above,
    existing,
    flat_names,
    place,
    training_splits,
    write_camera,
)
from proxnav.datasets.formats.row_numbers import check_width, numbers, without_header
from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.storage.tables import read_rows, write_rows

POSES = "_poses_gt.csv"
COLUMNS = ("x", "y", "z", "q1", "q2", "q3", "q4")
_SHORT = {"validation": "val"}
_LONG = {"val": "validation"}

URSO_CAMERA = Camera(1280, 960, 640.0, 480.0 / np.tan(np.deg2rad(73.7) / 2.0), 640.0, 480.0)
"""1280 x 960 px, 90 x 73.7 deg: of all URSO sets, which ship no camera file."""


def read(path: Path, options: ReadOptions) -> Labels:
    """A folder with all its parts, or one `*_poses_gt.csv` with the image list beside it."""
    files = sorted(path.glob(f"*{POSES}")) if path.is_dir() else [path]
    folder = path if path.is_dir() else path.parent
    records = [record for file in files for record in _part(file, options.quaternion_order or "xyzw")]
    camera = options.camera or camera_above(folder, levels=0) or URSO_CAMERA
    return Labels(tuple(records), camera, options.keypoints_m, options.keypoint_names, format="urso")


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """Image lists and poses per part, the images, and camera.json where the camera is not URSO's."""
    names: dict[str, list[list[object]]] = defaultdict(list)
    poses: dict[str, list[list[object]]] = defaultdict(list)
    parts = [stem for _, stem in training_splits(labels, options)]
    for record, name, part in zip(labels.records, flat_names(labels.records), parts, strict=True):
        poses[_SHORT.get(part, part)].append(list(_to_urso(need_pose(record, "urso"))))
        names[_SHORT.get(part, part)].append([checked_name(f"images/{name}", "urso")])
        place(record.image, folder / "images" / name, options)
    for part, rows in poses.items():
        write_rows(folder / f"{part}{POSES}", [COLUMNS, *rows])
        write_rows(folder / f"{part}_images.csv", names[part])
    write_camera(labels.camera if labels.camera != URSO_CAMERA else None, folder)


def _part(path: Path, order: Order) -> list[LabelRecord]:
    part = path.name.removesuffix(POSES)
    images = path.with_name(f"{part}_images.csv")
    if not path.name.endswith(POSES) or not images.is_file():
        raise InputError(f"{path}: URSO poses are <part>{POSES} with the names in {part}_images.csv beside them")
    names, rows = read_rows(images), without_header(read_rows(path), 0)
    if len(names) != len(rows):
        raise InputError(f"{path}: {len(rows)} poses for {len(names)} images in {images.name}; they go line by line")
    return [_record(path, n, name, row, order) for n, (name, row) in enumerate(zip(names, rows, strict=True), 1)]


def _record(path: Path, number: int, names: list[str], row: list[str], order: Order) -> LabelRecord:
    where = f"{path}, pose {number}"
    check_width(names, 1, where, "filename")
    check_width(row, len(COLUMNS), where, ",".join(COLUMNS))
    name, values = checked_name(names[0], where), numbers(row, where)
    x, y, z = values[:3]
    w, q1, q2, q3 = pose(values[3:], values[:3], order, where).q_wxyz
    T = Pose.from_wxyz("cam", "target", [w, q1, -q2, q3], [y, -z, x])
    part = path.name.removesuffix(POSES)
    shown = checked_name(name.removeprefix("images/").lstrip("/"), where)
    return LabelRecord(shown, T, split=_LONG.get(part, part), image=existing(path.parent, name))


def _to_urso(T: Pose) -> Float[np.ndarray, "7"]:
    w, q1, q2, q3 = quaternion.canonical(T.q_wxyz)
    x, y, z = T.t_m
    return np.array([z, x, -y, q1, -q2, q3, w])
