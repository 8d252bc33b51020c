"""What the KRN and SPNv2 tables share: filename, 4 numbers of a box, q (wxyz), r [m], then u, v of every point.

Both come without a header; where somebody put one, the columns are read by their names.
"""

from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.attitude import Order, pose
from proxnav.datasets.formats.labels import LabelRecord, Labels, need_pose
from proxnav.datasets.formats.named_columns import is_header, pose_columns
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import WriteOptions
from proxnav.datasets.formats.places import flat_names, place, training_splits, write_camera
from proxnav.datasets.formats.pose_bowl import refuse_pose_bowl
from proxnav.datasets.formats.row_numbers import numbers
from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.geometry.types import Box
from proxnav.storage.tables import read_rows, write_rows

_BEFORE_POINTS = 12  # filename, box, quaternion, position

Cells = Callable[[LabelRecord, str, str], tuple[str, Box, Float[np.ndarray, "m 2"]]]
"""(record, name, domain) to (first cell, box as the format has it, points (m, 2) as the format has them)."""


@dataclass(frozen=True, slots=True, eq=False)
class KeypointRow:
    """One row as it stands in the file."""

    filename: str
    box: Float[np.ndarray, "4"]
    T_cam_target: Pose
    points: Float[np.ndarray, "m 2"]


def read_keypoint_rows(path: Path, asked: Order | None, box: Sequence[str]) -> list[KeypointRow]:
    """Rows of equal width, without points where there are none; `box` names the sides in the order of the format.
    InputError names the row at fault.
    """
    rows = read_rows(path)
    refuse_pose_bowl(rows[0], path)
    width, named = len(rows[0]), is_header(rows[0])
    if width < _BEFORE_POINTS or width % 2:
        raise InputError(f"{path}: expected filename, box (4), q (4), r (3) and pairs u, v, found {width} columns")
    places = _named_places(rows[0], asked, box, str(path)) if named else list(range(width))
    order = asked or "wxyz"
    body = list(enumerate(rows, 1))[1 if named else 0 :]
    return [_row(row, places, "wxyz" if named else order, f"{path}, row {number}") for number, row in body]


def _row(row: Sequence[str], places: Sequence[int], order: Order, where: str) -> KeypointRow:
    if len(row) != len(places):
        raise InputError(f"{where}: expected {len(places)} columns as in the first row, found {len(row)}")
    row = [row[k] for k in places]
    values = numbers(row[1:], where)
    T = pose(values[4:8], values[8:11], order, where)
    return KeypointRow(checked_name(row[0], where), values[:4], T, values[11:].reshape(-1, 2))


def _named_places(header: Sequence[str], asked: Order | None, box: Sequence[str], where: str) -> list[int]:
    """Places of the columns in the order of the format; points are what is left, in their own order."""
    columns, names = pose_columns(header, asked, "wxyz", where), [cell.strip().lower() for cell in header]
    if not set(box) <= set(names):
        raise InputError(f"{where}: the header names no {', '.join(side for side in box if side not in names)}")
    first = [columns.filename, *(names.index(side) for side in box), *columns.quaternion, *columns.position]
    if columns.unit_m != 1.0 or columns.order != "wxyz":
        raise InputError(f"{where}: give positions in metres and quaternions as qw, qx, qy, qz in this table")
    return [*first, *(k for k in range(len(header)) if k not in first)]


def write_keypoint_rows(
    labels: Labels, folder: Path, options: WriteOptions, below: str, format: str, cells: Cells
) -> None:
    """`domain/<below>/<split>.csv` for every split, images and masks of every domain, and camera.json."""
    groups: dict[str, list[list[object]]] = defaultdict(list)
    splits = training_splits(labels, options)
    for record, name, (domain, stem) in zip(labels.records, flat_names(labels.records), splits, strict=True):
        T = need_pose(record, format)
        first, box, points = cells(record, name, domain)
        row = [checked_name(first, format), *box, *quaternion.canonical(T.q_wxyz), *T.t_m, *points.ravel()]
        groups[f"{domain}/{below}/{stem}.csv"].append(row)
        place(record.image, folder / domain / "images" / name, options)
        place(record.mask, folder / domain / "masks" / Path(name).with_suffix(".png"), options)
    for name, rows in groups.items():
        write_rows(folder / name, rows)
    write_camera(labels.camera, folder)
