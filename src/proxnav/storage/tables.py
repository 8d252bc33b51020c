"""Csv tables: rows of cells, columns of numbers, and the names that the columns of a vector have."""

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.storage.files import write_atomic

MAX_BYTES = 512 * 2**20
_LONGEST_CELL = 4096


def vector_columns(stem: str, unit: str) -> tuple[str, ...]:
    """Column names of a vector.

    >>> vector_columns("r_ric", "m")
    ('r_ric_x_m', 'r_ric_y_m', 'r_ric_z_m')
    """
    return tuple(f"{stem}_{axis}_{unit}" for axis in "xyz")


def quaternion_columns(stem: str) -> tuple[str, ...]:
    """Column names of a quaternion, scalar first."""
    return tuple(f"{stem}_{component}" for component in "wxyz")


def is_number(cell: str) -> bool:
    """Whether Python reads a cell as a float."""
    try:
        float(cell)
    except ValueError:
        return False
    return True


def read_rows(path: Path, most_bytes: int = MAX_BYTES) -> list[list[str]]:
    """Rows of stripped cells without the empty ones; InputError for what is no text or too large."""
    if not path.is_file():
        raise InputError(f"{path}: no such csv file")
    if path.stat().st_size > most_bytes:
        raise InputError(f"{path}: larger than {most_bytes // 2**20} MiB, which no such table is; split it")
    try:
        text = path.read_text(encoding="utf-8-sig")
        rows = [
            [cell.strip() for cell in row]
            for row in csv.reader(io.StringIO(text, newline=""), delimiter=_delimiter(text))
        ]
    except (UnicodeDecodeError, csv.Error, OSError) as error:
        raise InputError(f"{path}: not readable as csv ({error}); save it as comma-separated UTF-8 text") from None
    if any(len(cell) > _LONGEST_CELL for row in rows for cell in row):
        raise InputError(f"{path}: a cell of more than {_LONGEST_CELL} characters; this is no table of numbers")
    rows = [row for row in rows if any(row)]
    if not rows:
        raise InputError(f"{path}: holds no rows")
    return rows


def _delimiter(text: str) -> str:
    """The comma, unless the first line has none and has semicolons or tabs."""
    first = text.lstrip().partition("\n")[0]
    return next((mark for mark in ",;\t" if mark in first), ",")


@dataclass(frozen=True, slots=True, eq=False)
class NumberTable:
    """Columns of numbers under a header, beside one column of texts named `status`."""

    path: Path
    columns: Mapping[str, Float[np.ndarray, "n"]]
    """Columns by name; NaN where a cell is no number."""
    status: tuple[str, ...]
    """Texts of the column `status`, one a row; empty strings without such a column."""

    def block(self, *names: str) -> Float[np.ndarray, "n k"]:
        """The named columns side by side; InputError names one that is missing or holds no finite number."""
        for name in names:
            if name not in self.columns or not np.isfinite(self.columns[name]).all():
                raise InputError(f"{self.path}: column {name} is missing or holds something that is no finite number")
        return np.stack([self.columns[name] for name in names], axis=1)

    def column(self, name: str) -> Float[np.ndarray, "n"]:
        """One column of finite numbers."""
        return self.block(name)[:, 0]


def read_table(path: Path) -> NumberTable:
    """A csv with a header; InputError where rows have more or fewer cells than it."""
    header, *body = read_rows(path)
    if not body or any(len(row) != len(header) for row in body):
        raise InputError(f"{path}: expected a header and rows of as many cells; it is empty or cut short")
    found = dict(zip(header, zip(*body, strict=True), strict=True))
    status = tuple(found.pop("status", ("",) * len(body)))
    numbers = {name: np.array([float(c) if is_number(c) else np.nan for c in cells]) for name, cells in found.items()}
    return NumberTable(path, numbers, status)


def write_rows(path: Path, rows: Iterable[Sequence[object]]) -> Path:
    """Csv with LF line ends; floats in the shortest form that reads back equal."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows([[_cell(value) for value in row] for row in rows])
    write_atomic(path, text.getvalue().encode())
    return path


def write_columns(path: Path, table: Mapping[str, Sequence[object]]) -> Path:
    """Csv with a header, from columns of one length by name."""
    return write_rows(path, [list(table), *zip(*table.values(), strict=True)])


def _cell(value: object) -> object:
    return repr(float(value)) if isinstance(value, float | np.floating) else value
