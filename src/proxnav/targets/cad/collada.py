"""What the head of a COLLADA file declares, and whether it may be opened."""

import re
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import unquote

from proxnav.errors import InputError
from proxnav.targets.cad.beside import check_inside

_UNIT = re.compile(rb"<unit\b[^>]*?\bmeter\s*=\s*[\"']([^\"']{1,40})[\"']")
_UP = re.compile(rb"<up_axis>\s*([XYZ])_UP\s*</up_axis>")
_PICTURE = re.compile(rb"<init_from>(?:\s*<ref>)?\s*([^<]{1,2000}?)\s*<")


def collada_head(path: Path) -> tuple[float | None, str]:
    """(metres per unit, up axis) as the file declares them; no unit is None, no axis is y as COLLADA has it."""
    content = path.read_bytes()
    unit, up = _UNIT.search(content), _UP.search(content)
    try:
        metres = None if unit is None else float(unit.group(1))
    except ValueError:
        metres = -1.0
    if metres is not None and not 1e-9 < metres < 1e9:
        raise InputError(f"{path}: declares a unit of {unit and unit.group(1)!r} m; expected a positive length")
    return metres, "y" if up is None else up.group(1).decode().lower()


def check_collada(path: Path, size: int) -> None:
    """InputError where pycollada is missing, the file is no COLLADA, or a picture lies outside its folder."""
    content = path.read_bytes()
    if b"<COLLADA" not in content[:65536]:
        raise InputError(f"{path}: {size} bytes that are no COLLADA file (no <COLLADA> element)")
    if b"<!ENTITY" in content:
        raise InputError(f"{path}: defines XML entities, which no COLLADA file needs; export it again")
    for match in _PICTURE.finditer(content):
        check_inside(path, unquote(match.group(1).decode("utf-8", "replace")))
    if find_spec("collada") is None:
        raise InputError(f"{path}: COLLADA files are read by pycollada, which is not installed; "
                         'pip install "proxnav[cad]", or export a GLB')  # fmt: skip
