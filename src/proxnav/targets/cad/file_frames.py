"""Frames that a user names on a spacecraft, typed or in a file: docking port, sensors, centre of mass."""

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxnav.errors import InputError
from proxnav.storage.tables import is_number, read_rows
from proxnav.targets.target import CENTRE_OF_MASS

MAX_BYTES = 2**20
FILE_FRAME = "file"
"""Name of the CAD file's own frame among a target's frames."""
_NAME = re.compile(r"[A-Za-z]\w{0,39}")


@dataclass(frozen=True, slots=True)
class FramePlace:
    """Place of a named frame in the CAD file: coordinates in the file's unit, q_file_NAME (Hamilton, scalar first)."""

    r: tuple[float, float, float]
    q_wxyz: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)


def frame_places(words: Sequence[str], centre_of_mass: str | None = None) -> dict[str, FramePlace]:
    """Places by name from words NAME=X,Y,Z[,qw,qx,qy,qz] or names of .json and .csv files, and the centre of mass.

    >>> frame_places(["port=0,0,1.5"])["port"].r
    (0.0, 0.0, 1.5)
    """
    found: dict[str, FramePlace] = {}
    for word in words:
        name, equals, numbers = word.partition("=")
        new = {name: _place(f"--frame {word}", numbers.split(","))} if equals else _from_file(Path(word))
        twice = next((name for name in new if name in found), None)
        if twice is not None:
            raise InputError(f"frame '{twice}' is given twice; name every frame once")
        found |= new
    if centre_of_mass is not None:
        if CENTRE_OF_MASS in found:
            raise InputError("the centre of mass is given twice, as --centre-of-mass and as a frame; leave one out")
        found[CENTRE_OF_MASS] = FramePlace(triple("--centre-of-mass", centre_of_mass))
    for name in found:
        if not _NAME.fullmatch(name) or name in (FILE_FRAME, "target", "cam"):
            raise InputError(
                f"'{name}' cannot name a frame; expected a word such as docking_port, not file, target, cam"
            )
    return found


def triple(what: str, text: str) -> tuple[float, float, float]:
    """Three numbers of X,Y,Z; InputError beginning with `what`."""
    place = _place(f"{what} {text}", text.split(","))
    if text.count(",") != 2:
        raise InputError(f"{what} {text}: expected three numbers X,Y,Z in the file's unit")
    return place.r


def _place(what: str, cells: Sequence[object]) -> FramePlace:
    try:
        numbers = [float(str(cell)) for cell in cells]
    except ValueError:
        numbers = []
    if len(numbers) not in (3, 7) or not np.isfinite(numbers).all():
        raise InputError(f"{what}: expected X,Y,Z in the file's unit, or X,Y,Z,qw,qx,qy,qz")
    x, y, z = numbers[:3]
    if len(numbers) == 3:
        return FramePlace((x, y, z))
    norm = float(np.linalg.norm(numbers[3:]))
    if not abs(norm - 1.0) < 1e-3:
        raise InputError(f"{what}: its quaternion qw,qx,qy,qz has norm {norm:.4g}; expected 1")
    w, i, j, k = (float(v) / norm for v in numbers[3:])
    return FramePlace((x, y, z), (w, i, j, k))


def _from_file(path: Path) -> Mapping[str, FramePlace]:
    """Name -> numbers of a .json, or rows name,x,y,z[,qw,qx,qy,qz] of a .csv."""
    if path.suffix.lower() not in (".json", ".csv") or not path.is_file() or path.stat().st_size > MAX_BYTES:
        raise InputError(f"--frame {path}: expected NAME=X,Y,Z[,qw,qx,qy,qz], or a .json or .csv file of such frames")
    if path.suffix.lower() == ".csv":
        rows = [row for row in read_rows(path, MAX_BYTES) if len(row) > 1]
        return {row[0]: _place(f"{path}: {row[0]}", row[1:]) for row in rows if is_number(row[-1])}
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        content = None
    if not isinstance(content, dict) or not all(isinstance(v, list) for v in content.values()):
        raise InputError(f'{path}: expected {{"docking_port": [x, y, z], ...}} in the file\'s unit')
    return {str(name): _place(f"{path}: {name}", numbers) for name, numbers in content.items()}
