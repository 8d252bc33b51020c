"""Numbers of a table's columns, in SI."""

import numpy as np

from proxnav.errors import InputError
from proxnav.trajectories.readers.columns import Column
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.history import Series
from proxnav.trajectories.readers.text import fail, number
from proxnav.trajectories.readers.text_table import TextTable
from proxnav.trajectories.readers.units import LENGTH, speed


def lengths_or_speeds(table: TextTable, column: Column, config: ReaderConfig, unsaid: float | None = None) -> Series:
    """A length or speed column in SI; `unsaid` is the factor where neither the file nor the user says a unit.

    InputError for an unknown unit, and for none without `unsaid`.
    """
    moving = column.is_rate
    option, given = ("velocity-unit", config.velocity_unit) if moving else ("position-unit", config.position_unit)
    factor = column.factor
    if factor is None and column.unit:
        fail(table.path, 1, f"unknown unit '{column.unit}' of column {column.header}; use m, km, m/s or km/s")
    if factor is None and given is not None:
        factor = speed(given) if moving else LENGTH.get(given)
        if factor is None:
            raise InputError(f"--reader.{option} {given} is unknown; use {'m/s or km/s' if moving else 'm or km'}")
    factor = unsaid if factor is None else factor
    if factor is None:
        units = "m/s or km/s" if moving else "m or km"
        raise InputError(f"{table.path}: column {column.header} has no unit; say --reader.{option} {units}")
    return factor * cells_of(table, column)


def cells_of(table: TextTable, column: Column) -> Series:
    """A column as it is written; InputError names the line that holds no finite number."""
    texts = [cells[column.index] for _, cells in table.rows]
    try:
        values = np.array(texts, dtype=np.float64)
    except ValueError:
        values = np.array([np.nan])
    if np.isfinite(values).all():
        return values
    what = f"a number under {column.header}"  # the slow way finds the line at fault, and accepts Fortran's exponents
    return np.array([number(text, table.path, line, what) for text, (line, _) in zip(texts, table.rows, strict=True)])
