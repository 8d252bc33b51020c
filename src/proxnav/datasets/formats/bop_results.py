"""BOP result csv: scene_id,im_id,obj_id,score,R,t,time with R as 9 numbers row by row and t as 3 [mm], by spaces.

The time is -1 where it is not known. Names are BOP's, 000012.png; the scene is the split.
"""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.bop import MM
from proxnav.datasets.formats.bop_write import OBJECT_ID, image_ids
from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.row_numbers import check_width, numbers
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.storage.tables import read_rows, write_rows

COLUMNS = ("scene_id", "im_id", "obj_id", "score", "R", "t", "time")
_LARGEST_ID = 10**9


def read(path: Path, options: ReadOptions) -> Labels:
    """Rows; the best score where an image has several of the object."""
    rows = read_rows(path)
    if [cell.lower() for cell in rows[0]] == [column.lower() for column in COLUMNS]:
        rows = rows[1:]
    best: dict[tuple[int, int], LabelRecord] = {}
    objects: set[int] = set()
    for number, row in enumerate(rows, 1):
        where = f"{path}, pose {number}"
        check_width(row, len(COLUMNS), where, ",".join(COLUMNS))
        scene, image, obj = (_id(cell, where) for cell in row[:3])
        if options.object_id not in (None, obj):
            continue
        objects.add(obj)
        record = _record(row, scene, image, where)
        if (scene, image) not in best or record.score > best[scene, image].score:
            best[scene, image] = record
    if len(objects) > 1:
        ids = ", ".join(map(str, sorted(objects)[:8]))
        raise InputError(f"{path}: poses of objects {ids}; say which with --object-id")
    return Labels(
        tuple(best.values()), options.camera, options.keypoints_m, options.keypoint_names, "target", "bop-results"
    )


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """`results.csv`; images without a pose have no row, as BOP wants it."""
    rows: list[list[object]] = [list(COLUMNS)]
    for record, key in zip(labels.records, image_ids(labels.records), strict=True):
        if record.T_cam_target is not None:
            T = record.T_cam_target
            scene = int(record.split.rsplit("/", 1)[-1]) if record.split.rsplit("/", 1)[-1].isdecimal() else 0
            rows.append([scene, key, OBJECT_ID, record.score, _joined(T.R.ravel()), _joined(T.t_m * MM), -1])
    write_rows(folder / "results.csv", rows)


def _record(row: list[str], scene: int, image: int, where: str) -> LabelRecord:
    score, R, t_mm = numbers(row[3:4], where)[0], numbers(row[4].split(), where), numbers(row[5].split(), where)
    if R.size != 9 or t_mm.size != 3:
        raise InputError(f"{where}: R needs 9 numbers and t 3, found {R.size} and {t_mm.size}")
    try:
        T = Pose.from_rounded_matrix("cam", "target", R.reshape(3, 3), t_mm / MM)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None
    return LabelRecord(f"{image:06d}.png", T, split=f"{scene:06d}", score=float(score))


def _id(cell: str, where: str) -> int:
    if not (cell.isascii() and cell.isdecimal() and int(cell) < _LARGEST_ID):
        raise InputError(f"{where}: scene_id, im_id and obj_id are whole numbers, found {cell[:40]!a}")
    return int(cell)


def _joined(values: Float[np.ndarray, "..."]) -> str:
    return " ".join(repr(float(value)) for value in values)
