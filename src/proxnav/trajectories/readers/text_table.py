"""Rows and named columns from STK reports (text and csv), MATLAB csv and Basilisk csv; meaning comes later."""

import csv
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from proxnav.errors import InputError
from proxnav.storage.files import refused_csv
from proxnav.storage.tables import is_number
from proxnav.trajectories.readers.text import fail, read_lines

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eEdD][-+]?\d+)?")
_BOTH_MARKS = re.compile(r"[-+]?[\d.,]*(?:\.[\d]*,|,[\d]*\.)[\d.,]*")
_DASHES = re.compile(r"\s*-{3,}(\s+-{3,})*\s*")
_SAID_IN_TITLE = re.compile(r"(?:Satellite|Spacecraft|Object|Aircraft)?[-/ ]*(?P<object>[^:]*):\s*(?P<style>.+)")


@dataclass(frozen=True, slots=True)
class TextTable:
    """Text cells under column headers."""

    path: str
    headers: tuple[str, ...]
    rows: list[tuple[int, list[str]]]
    """(line number, cells), as many cells as headers."""
    object_name: str = ""
    """From a report's title."""
    style: str = ""
    """From a report's title, such as 'J2000 Position Velocity'."""


def read_csv(path: str | Path, columns: tuple[str, ...]) -> TextTable:
    """A csv with a header, which may repeat; without a header `columns` names the cells.

    Cells are parted by semicolons, tabs, commas or blanks; but for commas, the decimals' mark may be a comma.
    """
    lines = read_lines(path)
    delimiter = _delimiter(lines)
    with refused_csv(Path(path)):
        parsed = [
            (k, [cell.strip() for cell in row]) for k, row in enumerate(_rows_of_cells(lines, delimiter), start=1)
        ]
    filled = [(k, cells) for k, cells in parsed if any(cells) and not cells[0].startswith(("#", "%"))]
    if not filled:
        raise InputError(f"{path}: nothing but empty cells and comments; export the table again")
    headers = tuple(filled[0][1]) if _is_header(filled[0][1]) else ()
    names = columns or headers
    if not names:
        raise InputError(
            f"{path}: no header; name the {len(filled[0][1])} columns, for example --reader.columns t x y z vx vy vz"
        )
    body = [(k, cells) for k, cells in filled if not _is_header(cells)]
    if delimiter != ",":
        body = _with_decimal_points(path, body)
    return _checked(TextTable(str(path), tuple(names), body))


def read_report(path: str | Path) -> TextTable:
    """An STK report: title, header over a dashed line, rows of a time and numbers; head and dashes may repeat."""
    lines = read_lines(path)
    dashes = [k for k, line in enumerate(lines) if _DASHES.fullmatch(line)]
    if not dashes or dashes[0] == 0:
        raise InputError(f"{path}: no header over a dashed line; save the report as text or csv with its header")
    header = re.split(r"\s{2,}", lines[dashes[0] - 1].strip())
    groups = len(lines[dashes[0]].split())
    if len(header) != groups:
        fail(path, dashes[0], f"{len(header)} column names over {groups} dashed columns; save the report as csv")
    title, style = _title(lines[: dashes[0] - 1])
    rows = []
    for k, line in enumerate(lines[dashes[0] + 1 :], start=dashes[0] + 2):
        if re.match(r"\s*\d", line) and not (k < len(lines) and _DASHES.fullmatch(lines[k])):
            rows.append((k, line.strip().rsplit(maxsplit=groups - 1)))
    return _checked(TextTable(str(path), tuple(header), rows, title, style))


def is_report(lines: list[str]) -> bool:
    """Whether a dashed line stands among the first lines."""
    return any(_DASHES.fullmatch(line) for line in lines[:40])


def _is_header(cells: list[str]) -> bool:
    """Headers hold words in most cells; data hold them in the time cell at most."""
    return sum(map(_is_word, cells)) > max(1, len(cells) // 3)


def _is_word(cell: str) -> bool:
    return not is_number(cell) and bool(re.search("[A-Za-z]", cell))  # nan and inf are numbers


def _delimiter(lines: list[str]) -> str:
    """What parts the cells: a semicolon or a tab wherever there is one, since commas may be decimal; blanks at last."""
    first = next((line for line in lines if line.strip() and line.lstrip()[0] not in "#%"), "")
    return next((mark for mark in ";\t," if mark in first), " " if len(first.split()) > 1 else ",")


def _rows_of_cells(lines: list[str], delimiter: str) -> Iterable[list[str]]:
    return (line.split() for line in lines) if delimiter == " " else csv.reader(lines, delimiter=delimiter)


def _with_decimal_points(path: str | Path, rows: list[tuple[int, list[str]]]) -> list[tuple[int, list[str]]]:
    """The rows with the decimal commas of European files as points; InputError where a cell has both."""
    found = [(k, cell) for k, cells in rows for cell in cells if _DECIMAL_COMMA.fullmatch(cell)]
    both = next(((k, cell) for k, cells in rows for cell in cells if _BOTH_MARKS.fullmatch(cell)), None)
    if both is not None:
        fail(path, both[0], f"'{both[1]}' has a point and a comma; export numbers without marks between thousands")
    if not found:
        return rows
    return [(k, [c.replace(",", ".") if _DECIMAL_COMMA.fullmatch(c) else c for c in cells]) for k, cells in rows]


def _title(lines: list[str]) -> tuple[str, str]:
    for line in lines:
        match = _SAID_IN_TITLE.fullmatch(line.strip())
        if match and not re.match(r"\d", line.strip()):
            return match["object"].strip(), match["style"].strip()
    return "", ""


def _checked(table: TextTable) -> TextTable:
    if not table.rows:
        raise InputError(f"{table.path}: a header but no data rows; export it again")
    for line, cells in table.rows:
        if len(cells) != len(table.headers):
            fail(
                table.path,
                line,
                f"{len(cells)} cells under {len(table.headers)} columns; the line may be cut off: export it again",
            )
        if "" in cells:
            name = table.headers[cells.index("")] or "without a name"
            fail(table.path, line, f"the cell of column {name} is empty; drop the line or fill it")
    return table
