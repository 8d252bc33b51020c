"""Submissions to the pose challenges: csv, quaternion scalar first; where somebody put a header, it names the columns.

SPEC2019  filename, q1..q4, r1..r3
SPEC2021  category (lightbox or sunlamp), filename, q1..q4, r1..r3
"""

from pathlib import Path

from proxnav.datasets.formats.attitude import pose
from proxnav.datasets.formats.labels import LabelRecord, Labels, need_pose
from proxnav.datasets.formats.named_columns import NamedPose, is_header, named_poses
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.places import camera_above
from proxnav.datasets.formats.pose_bowl import refuse_pose_bowl
from proxnav.datasets.formats.row_numbers import check_width, numbers
from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.storage.tables import read_rows, write_rows

_CATEGORIES = ("lightbox", "sunlamp")


def read_2019(path: Path, options: ReadOptions) -> Labels:
    """SPEC2019 rows."""
    return _read(path, options, categories=0)


def read_2021(path: Path, options: ReadOptions) -> Labels:
    """SPEC2021 rows; the category is the split."""
    return _read(path, options, categories=1)


def write_2019(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """`submission.csv`."""
    write_rows(folder / "submission.csv", [_row(record, "spec2019") for record in labels.records])


def write_2021(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """`submission.csv` with categories; InputError for images of neither."""
    rows = []
    for record in labels.records:
        category = (record.split or options.split).split("/")[0]
        if category not in _CATEGORIES:
            raise InputError(
                f"'{record.filename}' is of part '{category}', and spec2021 knows {' and '.join(_CATEGORIES)} only; "
                "give --split for images that are in no part"
            )
        rows.append([category, *_row(record, "spec2021")])
    write_rows(folder / "submission.csv", rows)


def _read(path: Path, options: ReadOptions, categories: int) -> Labels:
    rows = read_rows(path)
    refuse_pose_bowl(rows[0], path)
    if is_header(rows[0]):
        found = named_poses(rows, options.quaternion_order, "wxyz", path)
    else:
        found = [_by_place(row, f"{path}, row {k}", options, categories) for k, row in enumerate(rows, 1)]
    records = [_record(one, categories) for one in found]
    camera = options.camera or camera_above(path.parent, levels=0)
    kind = "spec2021" if categories else "spec2019"
    return Labels(tuple(records), camera, options.keypoints_m, options.keypoint_names, format=kind)


def _by_place(row: list[str], where: str, options: ReadOptions, categories: int) -> NamedPose:
    check_width(row, 8 + categories, where, "category, " * categories + "filename, q1..q4, r1..r3")
    name = checked_name(row[categories], where)
    values = numbers(row[1 + categories :], where)
    T = pose(values[:4], values[4:], options.quaternion_order or "wxyz", where)
    return NamedPose(name, row[0] if categories else "", T, where)


def _record(one: NamedPose, categories: int) -> LabelRecord:
    if categories and one.part not in _CATEGORIES:
        raise InputError(f"{one.where}: category {one.part[:40]!a} is none of {', '.join(_CATEGORIES)}")
    return LabelRecord(one.filename, one.T_cam_target, one.status, one.part)


def _row(record: LabelRecord, format: str) -> list[object]:
    T = need_pose(record, format)
    return [checked_name(record.filename, format), *quaternion.canonical(T.q_wxyz), *T.t_m]
