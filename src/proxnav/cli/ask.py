"""Questions to whoever sits at the terminal; where nobody does, the option that answers them is named."""

import sys
from pathlib import Path

from proxnav.errors import InputError
from proxnav.targets.cad.from_mesh import file_extents
from proxnav.targets.cad.placement import UNITS_M


def ask(question: str, option: str) -> str:
    """The answer as text; InputError where nobody can be asked, or nothing is answered."""
    if not sys.stdin.isatty():
        raise InputError(f"{option} is missing: the {question}")
    answer = input(f"{question}: ").strip()
    if not answer:
        raise InputError(f"{option}: no answer; give the {question}")
    return answer


def ask_range(question: str, option: str) -> tuple[float, float]:
    """Two numbers."""
    words = ask(question, option).replace(",", " ").split()
    try:
        low, high = map(float, words)
    except ValueError:
        raise InputError(f"{option}: expected two numbers, found {' '.join(words)!r}") from None
    return low, high


def ask_unit(file: Path, without: tuple[str, ...]) -> tuple[str | None, float | None]:
    """(unit, true length of a mesh's largest extent [m]), one None; both where nobody sits there or it is known."""
    if not sys.stdin.isatty():
        return None, None
    extents, declared_m = file_extents(file, without)
    if declared_m is not None:
        return None, None
    largest = max(extents)
    print(f"{file}: {' x '.join(f'{v:.4g}' for v in extents)} units; its largest extent would be")
    for unit, metres in UNITS_M.items():
        print(f"  {unit:>3}: {largest * metres:.4g} m")
    answer = ask("unit (m, dm, cm, mm, in, ft), or the true length of the largest extent, such as 13.2 m", "--unit")
    length = answer.removesuffix("m").strip()
    if answer.endswith("m") and answer not in UNITS_M and length.replace(".", "", 1).isdigit():
        return None, float(length)
    return answer, None
