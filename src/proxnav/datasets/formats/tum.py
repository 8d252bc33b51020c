"""Trajectories: TUM text (time tx ty tz qx qy qz qw, as evo and SLAM tools use it) and our solution.csv.

A TUM line is the pose of the camera in a world, here in the target's frame: T_target_cam. Times in seconds are the
names of the records; in a data set they are those of its scenes, else the numbers in the file names.
"""

import warnings
from pathlib import Path

import numpy as np

from proxnav.datasets.formats.attitude import pose
from proxnav.datasets.formats.bop_write import image_ids
from proxnav.datasets.formats.labels import LabelRecord, Labels
from proxnav.datasets.formats.options import ReadOptions, WriteOptions
from proxnav.datasets.formats.row_numbers import numbers
from proxnav.errors import InputError, InputNote
from proxnav.geometry import Pose, quaternion
from proxnav.storage.files import write_atomic
from proxnav.storage.tables import quaternion_columns, read_table, vector_columns

_COLUMNS = 8
_LARGEST = 2**28
_SAME_S = 1e-9


def time_name(t_s: float) -> str:
    """Name of a record that is known by its time."""
    return f"{t_s:.9f}"


def read(path: Path, options: ReadOptions) -> Labels:
    """Lines of eight numbers, by spaces or commas; # begins a comment."""
    if path.stat().st_size > _LARGEST:
        raise InputError(f"{path}: larger than {_LARGEST // 2**20} MiB; split it")
    records = []
    for number, line in enumerate(path.read_text(encoding="utf-8-sig", errors="replace").splitlines(), 1):
        cells = line.partition("#")[0].replace(",", " ").split()
        if not cells:
            continue
        where = f"{path}, line {number}"
        if len(cells) != _COLUMNS:
            raise InputError(f"{where}: expected 8 numbers (time tx ty tz qx qy qz qw), found {len(cells)}")
        values = numbers(cells, where)
        q = values[4:] / max(float(np.linalg.norm(values[4:])), 1e-12) if _is_rounded(values[4:]) else values[4:]
        T = pose(q, values[1:4], options.quaternion_order or "xyzw", where).inverse()
        known = Pose("cam", "target", T.q_wxyz, T.t_m)
        records.append(LabelRecord(time_name(values[0]), known, t_s=float(values[0])))
    return Labels(_in_time(records, path), options.camera, options.keypoints_m, options.keypoint_names, format="tum")


def is_tum(path: Path) -> bool:
    """Whether the first line that is no comment has eight numbers."""
    with path.open(encoding="utf-8-sig", errors="replace") as file:
        lines = (line.partition("#")[0].replace(",", " ").split() for line in file.readlines(65536))
        first = next((cells for cells in lines if cells), [])
    try:
        return len([float(cell) for cell in first]) == _COLUMNS
    except ValueError:
        return False


def read_solution(path: Path, options: ReadOptions) -> Labels:
    """The poses of a solution.csv of `proxnav navigate`."""
    table = read_table(path)
    t, q = table.column("t_s"), table.block(*quaternion_columns("q_cam_target"))
    t_m = table.block(*vector_columns("t_cam_target", "m"))
    poses = [Pose.from_wxyz("cam", "target", q[k], t_m[k]) for k in range(len(t))]
    records = [LabelRecord(time_name(at), T, t_s=at) for at, T in zip(t.tolist(), poses, strict=True)]
    return Labels(_in_time(records, path), options.camera, options.keypoints_m, options.keypoint_names)


def write(labels: Labels, folder: Path, options: WriteOptions) -> None:
    """`trajectory.tum`, in the order of time; images without a pose have no line."""
    times = times_of(labels)
    lines = []
    for t_s, record in sorted(zip(times, labels.records, strict=True), key=lambda one: one[0]):
        if record.T_cam_target is not None:
            T = record.T_cam_target.inverse()
            q_xyzw = np.roll(quaternion.canonical(T.q_wxyz), -1)
            lines.append(" ".join([f"{t_s:.9f}", *(repr(float(v)) for v in (*T.t_m, *q_xyzw))]))
    head = "# time tx ty tz qx qy qz qw: camera in the target's frame [s, m]\n"
    write_atomic(folder / "trajectory.tum", (head + "".join(f"{line}\n" for line in lines)).encode())


def times_of(labels: Labels) -> list[float]:
    """Times of the records [s]; where the source has none, the numbers in the file names, said as an `InputNote`."""
    known = [record.t_s for record in labels.records if record.t_s is not None]
    if len(known) == len(labels.records):
        return known
    said = "the source has no times; the numbers in the file names are taken as seconds"
    warnings.warn(said, InputNote, stacklevel=2)
    return [float(key) for key in image_ids(labels.records)]


def _in_time(records: list[LabelRecord], path: Path) -> tuple[LabelRecord, ...]:
    steps = np.diff([record.t_s for record in records if record.t_s is not None])
    if (steps < _SAME_S).any():
        at = int(np.flatnonzero(steps < _SAME_S)[0]) + 1
        raise InputError(f"{path}: time {records[at].filename} is not after the one before; sort the lines by time")
    return tuple(records)


def _is_rounded(q: np.ndarray) -> bool:
    return bool(abs(float(np.linalg.norm(q)) - 1.0) < 1e-2)
