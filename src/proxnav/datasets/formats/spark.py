"""SPARK-like csv: header filename,sequence,Tx,Ty,Tz,Qx,Qy,Qz,Qw; the scalar is last, images in a folder per sequence.

The columns are those of public code for SPARK 2024; that its axes are OpenCV's is our reading, not documented.
"""

from pathlib import Path

import numpy as np

from proxnav.datasets.formats.attitude import pose
from proxnav.datasets.formats.labels import LabelRecord, Labels, need_pose
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import camera_above, existing, place, write_camera
from proxnav.datasets.formats.row_numbers import check_width, numbers, without_header
from proxnav.geometry import quaternion
from proxnav.storage.tables import read_rows, write_rows

COLUMNS = ("filename", "sequence", "Tx", "Ty", "Tz", "Qx", "Qy", "Qz", "Qw")


def read(path: Path, options: ReadOptions) -> Labels:
    """Rows with or without header; the sequence is the split."""
    order, records = options.quaternion_order or "xyzw", []
    for number, row in enumerate(without_header(read_rows(path), 2), 1):
        where = f"{path}, pose {number}"
        check_width(row, len(COLUMNS), where, ",".join(COLUMNS))
        name, sequence = checked_name(row[0], where), checked_name(row[1], where)
        values = numbers(row[2:], where)
        T = pose(values[3:], values[:3], order, where)
        image = existing(path.parent / sequence, name) or existing(path.parent / "images" / sequence, name)
        records.append(LabelRecord(name, T, split=sequence, image=image))
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
