"""The learning curve as a csv that grows while the run does."""

import csv
import io
from collections.abc import Mapping
from pathlib import Path

from proxnav.storage.files import cannot_write, write_atomic


def append_row(path: Path, row: Mapping[str, float | int | str]) -> None:
    """One more row; a new column name rewrites the header and leaves older rows empty there."""
    rows = read_rows(path)
    columns = list(rows[0]) if rows else []
    if rows and set(row) <= set(columns):
        try:
            with path.open("a", newline="") as file:
                csv.DictWriter(file, columns).writerow(dict(row))
        except OSError as error:
            raise cannot_write(path, error) from None
        return
    columns += [name for name in row if name not in columns]
    _write(path, columns, [*rows, {name: str(value) for name, value in row.items()}])


def cut_after(path: Path, step: int) -> None:
    """Removes the rows past `step`: a run that resumes there writes them again."""
    rows = read_rows(path)
    kept = [row for row in rows if int(row["step"]) <= step]
    if len(kept) < len(rows):
        _write(path, list(rows[0]), kept)


def read_rows(path: Path) -> list[dict[str, str]]:
    """All rows as text, none when there is no file."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return [row for row in rows if None not in row.values()]  # a full disk may have cut the last one


def _write(path: Path, columns: list[str], rows: list[dict[str, str]]) -> None:
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, columns, restval="")
    writer.writeheader()
    writer.writerows(rows)
    write_atomic(path, text.getvalue().encode())
