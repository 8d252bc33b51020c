"""Tables as histories: units and quaternion order from the headers, demanded from the user where these are silent."""

from pathlib import Path

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.epochs import Instant, parse_iso
from proxnav.storage.tables import is_number
from proxnav.trajectories.readers.columns import Column, understand
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.dates import from_julian_date, parse_date, parse_duration
from proxnav.trajectories.readers.history import (
    AttitudeHistory,
    History,
    OrbitHistory,
    Segment,
    Series,
    rate_note,
    split,
)
from proxnav.trajectories.readers.reference_frames import ORBITAL, ReferenceFrame, frame_kind
from proxnav.trajectories.readers.text import check_times, check_unit_quaternions, fail, number
from proxnav.trajectories.readers.text_table import TextTable
from proxnav.trajectories.readers.units import LENGTH, speed

_POSITION, _VELOCITY = ("x", "y", "z"), ("vx", "vy", "vz")
_RIC, _RIC_RATES = ("radial", "intrack", "crosstrack"), ("radialrate", "intrackrate", "crosstrackrate")
_DATE_FORMATS = ("utcg", "utcj", "utcjfour", "iso-ymd", "isoymd", "utc")


def histories(table: TextTable, config: ReaderConfig) -> list[History]:
    """Orbits and attitudes of every object in the table."""
    columns = understand(table.headers)
    epoch, t = _times(table, columns, config)
    check_times(t.tolist(), [line for line, _ in table.rows], table.path)
    found: list[History] = []
    for owner in dict.fromkeys(column.owner for column in columns if column.meaning not in ("", "t")):
        mine = {c.meaning: c for c in columns if c.owner == owner and c.meaning not in ("", "t")}
        name = owner or table.object_name or Path(table.path).stem
        if set(_POSITION) <= set(mine) or set(_RIC) <= set(mine):
            found.append(_orbit(table, config, name, epoch, t, mine))
        if {"q1", "q2", "q3", "q4"} <= set(mine) or {"qw", "qx", "qy", "qz"} <= set(mine) or "qw" in mine:
            found.append(_attitude(table, config, name, epoch, t, mine))
    if not found:
        raise InputError(
            f"{table.path}: no position (x, y, z or radial, in-track, cross-track) nor quaternion among the columns "
            f"{', '.join(table.headers)}; name them with the option columns"
        )
    return found


def _orbit(
    table: TextTable, config: ReaderConfig, name: str, epoch: Instant, t: Series, mine: dict[str, Column]
) -> OrbitHistory:
    relative = set(_RIC) <= set(mine)
    places, speeds = (_RIC, _RIC_RATES) if relative else (_POSITION, _VELOCITY)
    r = np.stack([_scaled(table, mine[key], config, t) for key in places], axis=-1)
    v = None
    if set(speeds) <= set(mine):
        v = np.stack([_scaled(table, mine[key], config, t) for key in speeds], axis=-1)
    frame = ReferenceFrame("ric") if relative else _frame(table, config, mine)
    segments = tuple(Segment(t[p], r[p], None if v is None else v[p]) for p in split(t, np.empty(0)))
    if v is None:
        return OrbitHistory(name, table.path, epoch, frame, segments, "lagrange", 6)
    return OrbitHistory(name, table.path, epoch, frame, segments, "hermite", 4)


def _attitude(
    table: TextTable, config: ReaderConfig, name: str, epoch: Instant, t: Series, mine: dict[str, Column]
) -> AttitudeHistory:
    q = np.stack([_cells(table, mine[key]) for key in _quaternion_columns(table, config, mine)], axis=-1)
    check_unit_quaternions(q, [line for line, _ in table.rows], table.path)
    q = quaternion.normalize(q)
    if config.quaternion_direction == "body_to_reference":
        q = quaternion.conjugate(q)
    segments = tuple(Segment(t[p], q[p]) for p in split(t, np.empty(0)))
    note = ""
    if {"wx", "wy", "wz"} <= set(mine) and all(mine[key].factor for key in ("wx", "wy", "wz")):
        rates = [mine[key].factor * _cells(table, mine[key]) for key in ("wx", "wy", "wz")]  # pyright: ignore
        note = rate_note(t, q, np.stack(rates, axis=-1))
    return AttitudeHistory(name, table.path, epoch, _frame(table, config, mine), segments, note=note)


def _quaternion_columns(table: TextTable, config: ReaderConfig, mine: dict[str, Column]) -> tuple[str, ...]:
    """Columns in the order w, x, y, z. Letters and Euler parameters say it; q1 to q4 do so in STK's reports only."""
    if {"qw", "qx", "qy", "qz"} <= set(mine):
        return ("qw", "qx", "qy", "qz")
    if {"qw", "q1", "q2", "q3"} <= set(mine):
        return ("qw", "q1", "q2", "q3")
    order = config.quaternion_order or ("xyzw" if table.style else None)
    if order is None:
        raise InputError(
            f"{table.path}: columns q1 to q4 do not say where the scalar is; give quaternion_order wxyz (MATLAB's "
            "Aerospace Toolbox) or xyzw (STK)"
        )
    return ("q1", "q2", "q3", "q4") if order == "wxyz" else ("q4", "q1", "q2", "q3")


def _scaled(table: TextTable, column: Column, config: ReaderConfig, t: Series) -> Series:
    """A length or speed column in SI."""
    moving = column.meaning in _VELOCITY or column.meaning.endswith("rate")
    option, given = ("velocity_unit", config.velocity_unit) if moving else ("position_unit", config.position_unit)
    factor = column.factor
    if factor is None and column.unit:
        fail(table.path, 1, f"unknown unit '{column.unit}' of column {column.header}; use m, km, m/s or km/s")
    if factor is None and given is not None:
        factor = speed(given) if moving else LENGTH.get(given)
        if factor is None:
            raise InputError(f"{option} '{given}' is unknown; use {'m/s or km/s' if moving else 'm or km'}")
    if factor is None:
        example = "km/s" if moving else "km"
        raise InputError(f"{table.path}: column {column.header} has no unit; give {option}, for example {example}")
    return factor * _cells(table, column)


def _cells(table: TextTable, column: Column) -> Series:
    texts = [cells[column.index] for _, cells in table.rows]
    try:
        values = np.array(texts, dtype=np.float64)
    except ValueError:
        values = np.array([np.nan])
    if np.isfinite(values).all():
        return values
    what = f"a number under {column.header}"  # the slow way finds the line at fault, and accepts Fortran's exponents
    return np.array([number(text, table.path, line, what) for text, (line, _) in zip(texts, table.rows, strict=True)])


def _frame(table: TextTable, config: ReaderConfig, mine: dict[str, Column]) -> ReferenceFrame:
    """From the option, else the report's title, else the headers; Basilisk writes ECI into its headers."""
    said = [config.frame or "", *table.style.split(), *(c.header.split()[0] for c in mine.values() if c.header.split())]
    for name in said:
        kind = frame_kind(name)
        if kind is not None and kind not in (*ORBITAL, "of_epoch"):
            return ReferenceFrame(kind)
    if config.frame:
        raise InputError(f"frame '{config.frame}' is unknown; use ICRF, J2000, Fixed, TEMEOfDate or MeanOfDate")
    raise InputError(f"{table.path}: the reference frame is not in the file; give frame, for example J2000 or Fixed")


def _times(table: TextTable, columns: list[Column], config: ReaderConfig) -> tuple[Instant, Series]:
    """(epoch, seconds past it): dates bring their epoch, elapsed times take the configured one."""
    named = [column for column in columns if column.meaning == "t"]
    column = named[0] if named else Column("time", 0, "t", "", "")
    if not named and columns[0].meaning:
        raise InputError(f"{table.path}: no time column among {', '.join(table.headers)}; name one t or Time")
    line, first = table.rows[0][0], table.rows[0][1][column.index]
    if column.unit == "jdate":
        return _dated([from_julian_date(value) for value in _cells(table, column)])
    if parse_duration(first) is not None:
        return parse_iso(config.epoch_utc), _durations(table, column)
    if column.unit in _DATE_FORMATS or not is_number(first):
        return _dated([_date(table, line, cells[column.index]) for line, cells in table.rows])
    if column.unit and column.factor is None:
        fail(table.path, line, f"unknown time unit '{column.unit}' of column {column.header}; use s or a date")
    unit_s = column.factor or 1.0
    return parse_iso(config.epoch_utc), unit_s * _cells(table, column)


def _dated(moments: list[Instant]) -> tuple[Instant, Series]:
    return moments[0], np.array([moment - moments[0] for moment in moments])


def _durations(table: TextTable, column: Column) -> Series:
    seconds = [parse_duration(cells[column.index]) for _, cells in table.rows]
    for (line, cells), value in zip(table.rows, seconds, strict=True):
        if value is None:
            fail(table.path, line, f"'{cells[column.index]}' is no duration such as 00:00:05 or 5 sec")
    return np.array(seconds, dtype=np.float64)


def _date(table: TextTable, line: int, text: str) -> Instant:
    try:
        return parse_date(text)
    except InputError as error:
        fail(table.path, line, str(error))
