"""Poses into a file whose ending says how: .json as SPEED+ has them, .csv as a table with a header."""

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.storage.files import check_new_file
from proxnav.storage.tables import write_rows

HEADER = ("filename", "status", "tx_m", "ty_m", "tz_m", "qw", "qx", "qy", "qz",
          *(f"sigma_t{axis}_m" for axis in "xyz"), *(f"sigma_r{axis}_rad" for axis in "xyz"))  # fmt: skip
"""Columns of the table: T_cam_target, and the standard deviations of (dt, dr), camera axes."""


def check_pose_file(path: Path) -> None:
    """InputError where no poses can be written to: to be asked before the work."""
    check_new_file(path)
    if path.suffix.lower() not in (".json", ".csv"):
        raise InputError(f"--out {path}: poses are written as .json or .csv; name such a file")


def write_pose_file(path: Path, records: Iterable[PoseRecord]) -> None:
    """Poses in the form that the ending names."""
    if path.suffix.lower() == ".csv":
        write_rows(path, [HEADER, *map(_row, records)])
    else:
        write_poses(path, records)


def _row(record: PoseRecord) -> list[object]:
    T = record.T_cam_target
    if T is None:
        return [record.filename, record.status, *[""] * (len(HEADER) - 2)]
    sigma = [""] * 6 if record.covariance is None else np.sqrt(np.diagonal(record.covariance)).tolist()
    return [record.filename, record.status, *T.t_m.tolist(), *quaternion.canonical(T.q_wxyz).tolist(), *sigma]
