"""Numbers in the rows of label tables, with every row checked."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.storage.numbers import LARGEST
from proxnav.storage.tables import is_number


def without_header(rows: list[list[str]], first_number: int) -> list[list[str]]:
    """Rows without a first one that has text where column `first_number` should hold a number."""
    head = rows[0]
    return rows[1:] if len(head) > first_number and not is_number(head[first_number]) else rows


def numbers(cells: Sequence[str], where: str) -> Float[np.ndarray, "n"]:
    """Finite numbers, or InputError that shows the cell at fault."""
    values = np.empty(len(cells))
    for index, cell in enumerate(cells):
        if not is_number(cell):
            raise InputError(f"{where}: expected a number, found {cell[:40]!a}")
        values[index] = float(cell)
        if not abs(values[index]) <= LARGEST:
            raise InputError(f"{where}: expected a finite number, found {cell[:40]!a}")
    return values


def check_width(row: Sequence[str], width: int, where: str, columns: str) -> None:
    """InputError unless the row has `width` cells."""
    if len(row) != width:
        raise InputError(f"{where}: expected {width} columns ({columns}), found {len(row)}")
