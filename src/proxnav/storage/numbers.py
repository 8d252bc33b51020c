"""Numbers from files: finite, as many as expected, and none so large that arithmetic on it overflows."""

from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError

LARGEST = 1e12
"""Beyond any length in metres, millimetres or pixels that a label can mean."""


def finite_numbers(value: Any, count: int | None, what: str) -> Float[np.ndarray, "n"]:
    """`value`, a number or nested lists of them, as a flat array; InputError says what needs how many."""
    try:
        numbers = np.array(value, dtype=np.float64).ravel()
    except (TypeError, ValueError, OverflowError):
        numbers = np.array([np.nan])
    if count not in (None, numbers.size) or not (np.abs(numbers) <= LARGEST).all():
        wanted = "finite numbers" if count is None else f"{count} finite numbers"
        raise InputError(f"{what} needs {wanted}, found {ascii(value)[:60]}")
    return numbers
