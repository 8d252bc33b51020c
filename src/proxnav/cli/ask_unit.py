"""Asks whoever sits at the terminal how large the spacecraft in a mesh file is."""

import sys
from pathlib import Path

from proxnav.targets.cad.from_mesh import file_extents
from proxnav.targets.cad.placement import UNITS_M


def ask_unit(file: Path, without: tuple[str, ...]) -> tuple[str | None, float | None]:
    """(unit, true length of the largest extent [m]), one None; both where nobody sits there or the file declares it."""
    if not sys.stdin.isatty():
        return None, None
    extents, declared_m = file_extents(file, without)
    if declared_m is not None:
        return None, None
    largest = max(extents)
    print(f"{file}: {' x '.join(f'{v:.4g}' for v in extents)} units; its largest extent would be")
    for unit, metres in UNITS_M.items():
        print(f"  {unit:>3}: {largest * metres:.4g} m")
    answer = input("unit (m, dm, cm, mm, in, ft), or the true length of the largest extent, such as 13.2 m: ").strip()
    length = answer.removesuffix("m").strip()
    if answer.endswith("m") and answer not in UNITS_M and length.replace(".", "", 1).isdigit():
        return None, float(length)
    return answer, None
