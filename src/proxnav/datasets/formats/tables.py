"""Csv with numbers: read with every row checked, written so that every number reads back equal."""

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.storage.files import write_atomic
from proxnav.storage.numbers import LARGEST

MAX_BYTES = 512 * 2**20
_LONGEST_CELL = 4096


def read_rows(path: Path) -> list[list[str]]:
    """Rows of stripped cells without the empty ones; InputError for what is no text or too large."""
    if not path.is_file():
        raise InputError(f"{path}: no such csv file")
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"{path}: larger than {MAX_BYTES // 2**20} MiB, which no table of poses is; split it")
    try:
        text = path.read_text(encoding="utf-8-sig")
        rows = [[cell.strip() for cell in row] for row in csv.reader(io.StringIO(text, newline=""))]
    except (UnicodeDecodeError, csv.Error, OSError) as error:
        raise InputError(f"{path}: not readable as csv ({error}); save it as comma-separated UTF-8 text") from None
    if any(len(cell) > _LONGEST_CELL for row in rows for cell in row):
        raise InputError(f"{path}: a cell of more than {_LONGEST_CELL} characters; this is no table of poses")
    rows = [row for row in rows if any(row)]
    if not rows:
        raise InputError(f"{path}: holds no rows")
    return rows


def without_header(rows: list[list[str]], first_number: int) -> list[list[str]]:
    """Rows without a first one that has text where column `first_number` should hold a number."""
    head = rows[0]
    return rows[1:] if len(head) > first_number and not _is_number(head[first_number]) else rows


def numbers(cells: Sequence[str], where: str) -> Float[np.ndarray, "n"]:
    """Finite numbers, or InputError that shows the cell at fault."""
    values = np.empty(len(cells))
    for index, cell in enumerate(cells):
        try:
            values[index] = float(cell)
        except ValueError:
            raise InputError(f"{where}: expected a number, found {cell[:40]!a}") from None
        if not abs(values[index]) <= LARGEST:
            raise InputError(f"{where}: expected a finite number, found {cell[:40]!a}")
    return values


def check_width(row: Sequence[str], width: int, where: str, columns: str) -> None:
    """InputError unless the row has `width` cells."""
    if len(row) != width:
        raise InputError(f"{where}: expected {width} columns ({columns}), found {len(row)}")


def write_rows(path: Path, rows: Iterable[Sequence[object]]) -> Path:
    """Csv with LF line ends; floats in the shortest form that reads back equal."""
    text = io.StringIO(newline="")
    csv.writer(text, lineterminator="\n").writerows([[_cell(value) for value in row] for row in rows])
    write_atomic(path, text.getvalue().encode())
    return path


def _cell(value: object) -> object:
    return repr(float(value)) if isinstance(value, float | np.floating) else value


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
