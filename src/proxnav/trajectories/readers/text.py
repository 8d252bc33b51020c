"""Lines and numbers of a text file, with errors that name the file and the line."""

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path
from typing import NoReturn

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.types import QuatWxyz

MAX_BYTES = 2**30
"""Largest trajectory file; a day at 10 Hz takes a tenth of it."""


def read_lines(path: str | Path) -> list[str]:
    """The file's lines without line ends and byte-order mark."""
    with _refused_if_unreadable(path):
        if Path(path).stat().st_size > MAX_BYTES:
            raise InputError(f"{path}: larger than {MAX_BYTES // 2**20} MiB; export fewer instants")
        raw = Path(path).read_bytes()
    if b"\x00" in raw:
        raise InputError(
            f"{path}: a binary file, neither MATLAB's nor a SPICE kernel; export it as text (.e, .a, csv, OEM or AEM)"
        )
    try:
        lines = raw.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError:
        lines = raw.decode("latin-1").splitlines()
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: empty file, expected a trajectory; export it again")
    return lines


def head_of(path: str | Path) -> bytes:
    """The first bytes, which say what kind of file it is."""
    with _refused_if_unreadable(path), Path(path).open("rb") as file:
        return file.read(128)


@contextmanager
def _refused_if_unreadable(path: str | Path) -> Iterator[None]:
    try:
        yield
    except FileNotFoundError:
        raise InputError(f"{path}: no such file; check the path") from None
    except OSError as error:
        raise InputError(f"{path}: not readable ({error.strerror}); check the path and its permissions") from None


def is_xml(path: str | Path) -> bool:
    """Whether the first character of a text file opens an element."""
    return head_of(path).removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<")


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
    for (before, now), line in zip(pairwise(t), lines[1:], strict=True):
        if now < before:
            fail(path, line, f"time goes backwards from {before:g} s to {now:g} s; sort the rows by time")


def check_unit_quaternions(q: QuatWxyz, lines: Sequence[int], path: str | Path) -> None:
    """Refuses quaternions (n, 4) whose norm departs from one by more than rounding; any order of components."""
    norm = np.linalg.norm(q, axis=1)
    wrong = np.flatnonzero(np.abs(norm - 1.0) > 2e-3)
    if wrong.size:
        k = int(wrong[0])
        found = f"the quaternion {q[k].tolist()} has norm {norm[k]:.6g}"
        fail(path, lines[k], f"{found}, expected 1; check the columns and their order")
