"""Lines and numbers of a text file, with errors that name the file and the line."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from proxnav.errors import InputError


def read_lines(path: str | Path) -> list[str]:
    """The file's lines without line ends and byte-order mark."""
    try:
        raw = Path(path).read_bytes()
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; check the path") from None
    except OSError as error:
        raise InputError(f"{path}: not readable ({error.strerror}); check the path and its permissions") from None
    if b"\x00" in raw:
        raise InputError(f"{path}: a binary file; export it as text (.e, .a, csv, OEM or AEM)")
    try:
        lines = raw.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        lines = raw.decode("latin-1").splitlines()
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: empty file, expected a trajectory; export it again")
    return lines


def fail(path: str | Path, line: int, message: str) -> NoReturn:
    """InputError that names the file and the line, counted from 1."""
    raise InputError(f"{path}, line {line}: {message}")


def number(token: str, path: str | Path, line: int, what: str = "a number") -> float:
    """A finite float; Fortran's D exponents are accepted."""
    try:
        value = float(token.replace("D", "e").replace("d", "e"))
    except ValueError:
        fail(path, line, f"expected {what}, found '{token}'; mend the line or export the file again")
    if not math.isfinite(value):
        fail(path, line, f"expected {what}, found '{token}', which is not finite; drop or mend the line")
    return value


def numbers(tokens: Sequence[str], count: int, path: str | Path, line: int, what: str) -> list[float]:
    """Exactly `count` floats."""
    if len(tokens) != count:
        fail(path, line, f"{what} needs {count} numbers, found {len(tokens)}; the line may be cut off")
    return [number(token, path, line) for token in tokens]


def check_times(t: Sequence[float], lines: Sequence[int], path: str | Path) -> None:
    """Refuses time going backwards; equal neighbours are left to the caller."""
    for k in range(1, len(t)):
        if t[k] < t[k - 1]:
            fail(path, lines[k], f"time goes backwards from {t[k - 1]:g} s to {t[k]:g} s; sort the rows by time")


def check_unit_quaternion(q: Sequence[float], path: str | Path, line: int) -> None:
    """Refuses quaternions whose norm departs from one by more than rounding."""
    norm = math.sqrt(sum(value * value for value in q))
    if abs(norm - 1.0) > 2e-3:
        fail(path, line, f"the quaternion {list(q)} has norm {norm:.6g}, expected 1; check the columns and their order")
