"""Sensor records as csv, one file a sensor in one folder; docs/navigation.md lists the columns.

Single rows that cannot be are left out and counted; a file that is implausible as a whole is refused in one sentence.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.sensor_records.plausibility import Range, Rows, check_table
from proxnav.errors import InputError
from proxnav.records import (
    AccelerometerData,
    EphemerisData,
    GnssData,
    GyroData,
    KeypointData,
    PoseData,
    SensorRecords,
    StarTrackerData,
)
from proxnav.storage.files import read_json, refused_csv, write_json
from proxnav.storage.tables import quaternion_columns, vector_columns, write_rows

_UPPER = [(i, j) for i in range(6) for j in range(i, 6)]
_POSE_COVARIANCE = tuple(f"c{i}{j}" for i, j in _UPPER)


@dataclass(frozen=True)
class _Table:
    """Columns of one file in order, and what is plausible in each block of them."""

    columns: tuple[str, ...]
    ranges: Mapping[str, Range]
    """By prefix of the column names."""


TABLES = {
    "ephemeris": _Table(
        ("t_s", *vector_columns("r_eci", "m"), *vector_columns("v_eci", "mps")),
        {"r_eci": Range(6.4e6, 5e7, "m"), "v_eci": Range(1e3, 1.2e4, "m/s")},
    ),
    "gyro": _Table(("t_s", *vector_columns("rate", "rad_s")), {"rate": Range(1e-6, 0.3, "rad/s")}),
    "accelerometer": _Table(
        ("t_s", *vector_columns("force", "mps2"), "thrust"), {"force": Range(0.0, 0.3, "m/s^2", row=50.0)}
    ),
    "gnss": _Table(
        ("t_s", "received_s", *vector_columns("r_eci", "m"), *vector_columns("v_eci", "mps"), "sigma_r_m",
         "sigma_v_mps"),
        {"r_eci": Range(1.0, 2e4, "m"), "v_eci": Range(1e-5, 50.0, "m/s"), "sigma_r": Range(1e-4, 100.0, "m"),
         "sigma_v": Range(1e-6, 10.0, "m/s")},
    ),
    "star_tracker": _Table(
        ("t_s", "received_s", *quaternion_columns("q_eci_cam"), *vector_columns("sigma", "rad")),
        {"q_eci": Range(0.99, 1.01, "(norm)"), "sigma": Range(1e-7, 0.05, "rad")},
    ),
    "keypoints": _Table(
        ("t_s", "received_s", "keypoint", "u_px", "v_px", "cov_uu_px2", "cov_uv_px2", "cov_vv_px2"),
        {"cov_uu": Range(1e-6, 1e5, "px^2"), "cov_vv": Range(1e-6, 1e5, "px^2"), "u_px": Range(0.0, 1e5, "px"),
         "v_px": Range(0.0, 1e5, "px")},
    ),
    "poses": _Table(
        ("t_s", "received_s", *quaternion_columns("q_cam_target"), *vector_columns("t_cam_target", "m"),
         *_POSE_COVARIANCE),
        {"q_cam": Range(0.99, 1.01, "(norm)"), "t_cam": Range(0.5, 2e4, "m")},
    ),
}  # fmt: skip


@dataclass(frozen=True)
class ReadRecords:
    """Records and what was left out of them."""

    records: SensorRecords
    rejected: Mapping[str, Mapping[str, int]]
    """Rows left out, by file and reason."""


def write_records(folder: Path, records: SensorRecords) -> None:
    """One csv per sensor and `records.json` with the epoch."""
    write_json(folder / "records.json", {"version": 1, "epoch_utc": records.epoch_utc}, indent=1)
    for name, rows in _rows(records).items():
        write_rows(folder / f"{name}.csv", [TABLES[name].columns, *rows.tolist()])


def read_records(folder: Path) -> ReadRecords:
    """All csv files of a records folder; only the ephemeris must be there, and keypoints or poses."""
    epoch = _read_epoch(folder / "records.json")
    found, rejected = {}, {}
    for name, table in TABLES.items():
        path = folder / f"{name}.csv"
        if path.is_file():
            raw, malformed = _read_table(path, table.columns)
            found[name], reasons = check_table(str(path), table.columns, raw, table.ranges)
            counts = reasons | ({"not numbers": malformed} if malformed else {})
            if counts:
                rejected[name] = counts
    if "ephemeris" not in found:
        raise InputError(f"{folder}: no ephemeris.csv; the filter needs the target's orbit to know up from ahead")
    if "keypoints" not in found and "poses" not in found:
        raise InputError(f"{folder}: neither keypoints.csv nor poses.csv; the filter needs one of them to start")
    return ReadRecords(_records(epoch, found), rejected)


def _rows(records: SensorRecords) -> dict[str, Rows]:
    e, out = records.ephemeris, {}
    out["ephemeris"] = np.c_[e.t, e.r_eci_m, e.v_eci_mps]
    if (g := records.gyro) is not None:
        out["gyro"] = np.c_[g.t, g.rate]
    if (a := records.accelerometer) is not None:
        out["accelerometer"] = np.c_[a.t, a.specific_force, a.thrust]
    if (n := records.gnss) is not None:
        out["gnss"] = np.c_[n.t, n.received, n.position_m, n.velocity_mps, n.sigma_position_m, n.sigma_velocity_mps]
    if (s := records.star_tracker) is not None:
        out["star_tracker"] = np.c_[s.t, s.received, s.q_eci_cam, s.sigma_rad]
    if (k := records.keypoints) is not None:
        out["keypoints"] = _keypoint_rows(k)
    if (p := records.poses) is not None:
        upper = np.stack([p.covariance[:, i, j] for i, j in _UPPER], axis=1)
        out["poses"] = np.c_[p.t, p.received, p.q_cam_target, p.t_cam_target_m, upper]
    return out


def _keypoint_rows(data: KeypointData) -> Rows:
    frame, index = np.nonzero(np.isfinite(data.pixels[..., 0]))
    cov = data.covariances_px2[frame, index]
    return np.c_[
        data.t[frame], data.received[frame], index, data.pixels[frame, index], cov[:, 0, 0], cov[:, 0, 1], cov[:, 1, 1]
    ]


def _records(epoch: str, found: Mapping[str, Rows]) -> SensorRecords:
    def columns(name: str, *cuts: int) -> list[Rows] | None:
        return np.split(found[name], cuts, axis=1) if name in found else None

    def flat(parts: list[Rows], *which: int) -> list[Float[np.ndarray, "..."]]:
        return [part[:, 0] if i in which else part for i, part in enumerate(parts)]

    e, g, a = columns("ephemeris", 1, 4), columns("gyro", 1), columns("accelerometer", 1, 4)
    n, s, p = columns("gnss", 1, 2, 5, 8, 9), columns("star_tracker", 1, 2, 6), columns("poses", 1, 2, 6, 9)
    assert e is not None
    return SensorRecords(
        epoch,
        EphemerisData(*flat(e, 0)),
        gyro=GyroData(*flat(g, 0)) if g else None,
        accelerometer=AccelerometerData(*flat(a, 0, 2)) if a else None,
        gnss=GnssData(*flat(n, 0, 1, 4, 5)) if n else None,
        star_tracker=StarTrackerData(*flat(s, 0, 1)) if s else None,
        keypoints=_keypoints(found["keypoints"]) if "keypoints" in found else None,
        poses=PoseData(p[0][:, 0], p[1][:, 0], p[2], p[3], _full(p[4])) if p else None,
    )


def _keypoints(rows: Rows) -> KeypointData:
    """Frames from rows of single keypoints; the frames keep their order of arrival."""
    frames, first, inverse = np.unique(rows[:, :2], axis=0, return_index=True, return_inverse=True)
    order = np.argsort(first, kind="stable")
    place = np.argsort(order)[inverse.ravel()]
    index, n = rows[:, 2].astype(int), int(rows[:, 2].max(initial=-1)) + 1
    pixels, cov = np.full((len(frames), n, 2), np.nan), np.full((len(frames), n, 2, 2), np.nan)
    pixels[place, index] = rows[:, 3:5]
    cov[place, index] = rows[:, [5, 6, 6, 7]].reshape(-1, 2, 2)
    return KeypointData(frames[order, 0], frames[order, 1], pixels, cov)


def _full(upper: Float[np.ndarray, "n 21"]) -> Float[np.ndarray, "n 6 6"]:
    out = np.zeros((len(upper), 6, 6))
    for column, (i, j) in enumerate(_UPPER):
        out[:, i, j] = out[:, j, i] = upper[:, column]
    return out


def _read_epoch(path: Path) -> str:
    content = read_json(path, "the JSON object of a records folder with the key epoch_utc")
    if not isinstance(content, dict) or "epoch_utc" not in content:
        raise InputError(f"{path}: expected a JSON object with the key epoch_utc")
    return str(content["epoch_utc"])


def read_columns(path: Path, columns: Sequence[str]) -> Rows:
    """Values of the named columns; InputError names what is missing or no number."""
    if not path.is_file():
        raise InputError(f"{path}: no such file; expected a csv with the columns {', '.join(columns)}")
    rows, malformed = _read_table(path, columns)
    if malformed:
        raise InputError(f"{path}: {malformed} rows hold something that is no number")
    return rows


def _read_table(path: Path, columns: Sequence[str]) -> tuple[Rows, int]:
    """Values in the order of `columns`, whatever the order in the file, and how many rows were no numbers."""
    with path.open(newline="", encoding="utf-8-sig", errors="replace") as file, refused_csv(path):
        reader = csv.reader(file)
        header = [name.strip() for name in next(reader, [])]
        missing = [name for name in columns if name not in header]
        if missing:
            raise InputError(f"{path}: column {missing[0]} is missing; found {', '.join(header) or 'nothing'}")
        take = [header.index(name) for name in columns]
        rows, malformed = [], 0
        for row in reader:
            try:
                rows.append([float(row[i]) for i in take])
            except (ValueError, IndexError):
                malformed += 1
    return np.array(rows, dtype=np.float64).reshape(-1, len(columns)), malformed
