"""What the KRN and SPNv2 tables share: filename, 4 numbers of a box, q (wxyz), r [m], then u, v of every point."""

from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.attitude import Order, pose
from proxnav.datasets.formats.labels import LabelRecord, Labels, need_pose
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.options import WriteOptions
from proxnav.datasets.formats.places import flat_names, place, training_splits, write_camera
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


def read_keypoint_rows(path: Path, order: Order) -> list[KeypointRow]:
    """Rows of equal width; InputError names the row at fault."""
    rows, found = read_rows(path), []
    width = len(rows[0])
    if width <= _BEFORE_POINTS or width % 2:
        raise InputError(f"{path}: expected filename, box (4), q (4), r (3) and pairs u, v, found {width} columns")
    for number, row in enumerate(rows, 1):
        where = f"{path}, row {number}"
        if len(row) != width:
            raise InputError(f"{where}: expected {width} columns as in the first row, found {len(row)}")
        values = numbers(row[1:], where)
        T = pose(values[4:8], values[8:11], order, where)
        found.append(KeypointRow(checked_name(row[0], where), values[:4], T, values[11:].reshape(-1, 2)))
    return found


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
