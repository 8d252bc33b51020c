"""Times of a table: dates, durations or elapsed seconds."""

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.epochs import Instant, parse_iso
from proxnav.storage.tables import is_number
from proxnav.trajectories.readers.columns import Column
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.dates import from_julian_date, parse_date, parse_duration
from proxnav.trajectories.readers.history import Series
from proxnav.trajectories.readers.table_cells import cells_of
from proxnav.trajectories.readers.text import fail
from proxnav.trajectories.readers.text_table import TextTable

_DATE_FORMATS = ("utcg", "utcj", "utcjfour", "iso-ymd", "isoymd", "utc")


def times_of(table: TextTable, columns: list[Column], config: ReaderConfig) -> tuple[Instant, Series]:
    """(epoch, seconds past it): dates bring their epoch, elapsed times take the configured one."""
    named = [column for column in columns if column.meaning == "t"]
    column = named[0] if named else Column("time", 0, "t", "", "")
    if not named and columns[0].meaning:
        raise InputError(f"{table.path}: no time column among {', '.join(table.headers)}; name one t or Time")
    line, first = table.rows[0][0], table.rows[0][1][column.index]
    if column.unit == "jdate":
        return _dated([from_julian_date(value) for value in cells_of(table, column)])
    if parse_duration(first) is not None:
        return parse_iso(config.epoch_utc), _durations(table, column)
    if column.unit in _DATE_FORMATS or not is_number(first):
        return _dated([_date(table, line, cells[column.index]) for line, cells in table.rows])
    if column.unit and column.factor is None:
        fail(table.path, line, f"unknown time unit '{column.unit}' of column {column.header}; use s or a date")
    unit_s = column.factor or 1.0
    return parse_iso(config.epoch_utc), unit_s * cells_of(table, column)


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
