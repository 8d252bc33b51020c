"""Numbers as people read them."""

import math
from typing import Any


def number(value: Any) -> str:
    """Four digits, or a dash where there is no finite number.

    >>> number(0.123456), number(None)
    ('0.1235', '–')
    """
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        return "–"
    return f"{value:.4g}"
