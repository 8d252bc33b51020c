"""Sensor records as csv, one file a sensor in one folder; docs/navigation.md lists the columns.

Single rows that cannot be are left out and counted; a file that is implausible as a whole is refused in one sentence.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.datasets.sensor_records.plausibility import Rows, check_table
from proxnav.datasets.sensor_records.record_tables import TABLES, records_of, rows_of
from proxnav.errors import InputError
from proxnav.records import Antennas, SensorRecords
from proxnav.storage.files import read_json, refused_csv, write_json
from proxnav.storage.tables import write_rows

_FRAMES = {"J2000", "GCRF", "ICRF", "EME2000"}
"""Names of axes that agree within 0.03 arcsec."""


@dataclass(frozen=True)
class ReadRecords:
    """Records and what was left out of them."""

    records: SensorRecords
    rejected: Mapping[str, Mapping[str, int]]
    """Rows left out, by file and reason."""


def write_records(folder: Path, records: SensorRecords) -> None:
    """One csv per sensor and `records.json` with the epoch."""
    about = {"version": 1, "epoch_utc": records.epoch_utc, "frame": "J2000"}
    if records.antennas is not None:
        about["antennas"] = asdict(records.antennas)
    write_json(folder / "records.json", about, indent=1)
    for name, rows in rows_of(records).items():
        write_rows(folder / f"{name}.csv", [TABLES[name].columns, *rows.tolist()])


def read_records(folder: Path) -> ReadRecords:
    """All csv files of a records folder; only the ephemeris must be there, and keypoints or poses."""
    found = read_other_records(folder)
    if found.records.keypoints is None and found.records.poses is None:
        raise InputError(f"{folder}: neither keypoints.csv nor poses.csv; the filter needs one of them to start")
    return found


def read_other_records(folder: Path) -> ReadRecords:
    """All csv files of a records folder; only the ephemeris must be there: the camera's part comes from elsewhere."""
    epoch, antennas = _read_about(folder / "records.json")
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
    return ReadRecords(records_of(epoch, found, antennas), rejected)


def _read_about(path: Path) -> tuple[str, Antennas | None]:
    """(epoch, ends of the GNSS baseline)."""
    content = read_json(path, "the JSON object of a records folder with the key epoch_utc")
    if not isinstance(content, dict) or "epoch_utc" not in content:
        raise InputError(f"{path}: expected a JSON object with the key epoch_utc")
    frame = str(content.get("frame", "J2000"))
    if frame.upper() not in _FRAMES:
        raise InputError(
            f"{path}: the axes of ephemeris, star tracker and GNSS must be those of J2000 (or GCRF, ICRF), found "
            f"frame '{frame}': turn them first, as proxnav convert does with an ephemeris"
        )
    return str(content["epoch_utc"]), _antennas(path, content["antennas"]) if "antennas" in content else None


def _antennas(path: Path, given: Any) -> Antennas:
    names = [f.name for f in fields(Antennas)]
    try:
        ends = {name: tuple(map(float, given[name])) for name in names}
    except (TypeError, KeyError, ValueError):
        ends = {}
    if not ends or any(len(end) != 3 or not np.isfinite(end).all() for end in ends.values()):
        raise InputError(f"{path}: antennas needs {' and '.join(names)}, three numbers [m] each, found {given}")
    return Antennas(**ends)  # type: ignore[arg-type]


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
