"""SPARK-like csv: header filename,sequence,Tx,Ty,Tz,Qx,Qy,Qz,Qw; the scalar is last, images in a folder per sequence.

Where there is a header, columns are read by their names, in any order; without one the order above is taken.

The columns are those of public code for SPARK 2024; that its axes are OpenCV's is our reading, not documented.
"""

from pathlib import Path

import numpy as np

from proxnav.datasets.formats.attitude import pose
from proxnav.datasets.formats.labels import LabelRecord, Labels, need_pose
from proxnav.datasets.formats.named_columns import NamedPose, is_header, named_poses
from proxnav.datasets.formats.names import checked_name, is_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import camera_above, existing, place, write_camera
from proxnav.datasets.formats.pose_bowl import refuse_pose_bowl
from proxnav.datasets.formats.row_numbers import check_width, numbers
from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.storage.tables import read_rows, write_rows

COLUMNS = ("filename", "sequence", "Tx", "Ty", "Tz", "Qx", "Qy", "Qz", "Qw")


def read(path: Path, options: ReadOptions) -> Labels:
    """Rows with or without header; the sequence is the split."""
    rows = read_rows(path)
    refuse_pose_bowl(rows[0], path)
    if is_header(rows[0]):
        found = named_poses(rows, options.quaternion_order, "xyzw", path)
    else:
        found = [_by_place(row, f"{path}, pose {k}", options) for k, row in enumerate(rows, 1)]
    records = [_record(one, path.parent) for one in found]
    camera = options.camera or camera_above(path.parent, levels=1)
    return Labels(tuple(records), camera, options.keypoints_m, options.keypoint_names, format="spark")


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """`poses.csv`, and the images below their sequence."""
    rows: list[list[object]] = [list(COLUMNS)]
    for record in labels.records:
        T = need_pose(record, "spark")
        sequence = (record.split or options.split or "sequence").replace("/", "_")
        q_xyzw = np.roll(quaternion.canonical(T.q_wxyz), -1)
        rows.append([checked_name(record.filename, "spark"), checked_name(sequence, "spark"), *T.t_m, *q_xyzw])
        place(record.image, folder / sequence / record.filename, options)
    write_rows(folder / "poses.csv", rows)
    write_camera(labels.camera, folder)


def _by_place(row: list[str], where: str, options: ReadOptions) -> NamedPose:
    check_width(row, len(COLUMNS), where, ",".join(COLUMNS))
    if not is_name(row[0]):
        raise InputError(f"{where}: expected the file name of an image, found {row[0][:40]!a}; is this another table?")
    values = numbers(row[2:], where)
    T = pose(values[3:], values[:3], options.quaternion_order or "xyzw", where)
    return NamedPose(checked_name(row[0], where), row[1], T, where)


def _record(one: NamedPose, folder: Path) -> LabelRecord:
    sequence = checked_name(one.part, one.where) if one.part else ""
    image = existing(folder / sequence, one.filename) or existing(folder / "images" / sequence, one.filename)
    return LabelRecord(one.filename, one.T_cam_target, one.status, sequence, image=image)
