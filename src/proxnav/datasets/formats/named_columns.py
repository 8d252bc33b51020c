"""Pose tables read by the names over their columns, whatever their order; what is missing or named twice is refused."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from proxnav.datasets.formats.attitude import Order, pose
from proxnav.datasets.formats.names import checked_name
from proxnav.datasets.formats.row_numbers import check_width, numbers
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.storage.tables import is_number

_NAMES = ("filename", "file", "file_name", "image", "img", "image_name", "name", "imagename", "image_path", "path")
_PARTS = ("sequence", "seq", "category", "domain", "split", "trajectory", "scene", "set")
_POSITION = ("t{}", "{}", "t_{}", "r{}", "r_{}", "p{}", "p_{}", "pos_{}", "position_{}", "trans_{}", "translation_{}")
_QUATERNION = ("q{}", "q_{}", "quat_{}", "quaternion_{}", "rot_{}", "{}")
_UNITS = {"": 1.0, "m": 1.0, "mm": 1e-3, "cm": 1e-2, "km": 1e3}
_WITH_UNIT = re.compile(r"^(?P<name>.*?)\s*(?:[\[(]\s*(?P<bracket>\w*)\s*[\])]|_(?P<suffix>m|mm|cm|km))?$")


@dataclass(frozen=True, slots=True)
class PoseColumns:
    """Where the cells of a pose stand in a row."""

    width: int
    filename: int
    part: int | None
    """Sequence, category or the like; None where no column is named so."""
    position: tuple[int, int, int]
    unit_m: float
    """Length of the positions' unit [m]."""
    quaternion: tuple[int, int, int, int]
    order: Order
    """Order of the four cells as they are named here."""

    def pose(self, row: Sequence[str], where: str) -> Pose:
        """T_cam_target of a row."""
        t_m = numbers([row[k] for k in self.position], where) * self.unit_m
        return pose(numbers([row[k] for k in self.quaternion], where), t_m, self.order, where)


def is_header(row: Sequence[str]) -> bool:
    """Whether a row names columns: no cell of it is a number, and none looks like data."""
    return len(row) > 1 and not any(is_number(cell) for cell in row) and all(len(cell) < 64 for cell in row)


def pose_columns(header: Sequence[str], asked: Order | None, usual: Order, where: str) -> PoseColumns:
    """The columns by their names; InputError where one is missing or named twice, or names contradict `asked`.

    Numbered quaternions (q1 to q4) are in the order that is asked for, else in the `usual` one of the format; q0 to q3
    is scalar first.
    """
    split = [_split(cell) for cell in header]
    names = [name for name, _ in split]
    twice = next((name for name in names if name and names.count(name) > 1), None)
    if twice is not None:
        raise InputError(f"{where}: the header names column '{twice}' twice; each may stand once")
    filename, part = _first(names, _NAMES), _first(names, _PARTS)
    position, (quaternion, order) = _vector(names), _quaternion(names, asked, usual, where)
    if filename is None or position is None or quaternion is None:
        raise InputError(f"{where}: {_lacking(header, filename, position, quaternion)}")
    units = {unit for _, unit in (split[k] for k in position)}
    if len(units) > 1 or not units <= set(_UNITS):
        raise InputError(f"{where}: positions must be in one unit of m, mm, cm or km; found {', '.join(sorted(units))}")
    return PoseColumns(len(header), filename, part, position, _UNITS[units.pop()], quaternion, order)


def _split(cell: str) -> tuple[str, str]:
    """(name, unit) of a header's cell: ('tx', 'mm') of 'Tx [mm]'."""
    match = _WITH_UNIT.match(cell.strip().lower())
    assert match is not None
    return match["name"].strip().replace(" ", "_"), match["bracket"] or match["suffix"] or ""


def _first(names: Sequence[str], known: Sequence[str]) -> int | None:
    return next((names.index(name) for name in known if name in names), None)


def _vector(names: Sequence[str]) -> tuple[int, int, int] | None:
    for form in _POSITION:
        for axes in ("xyz", "123"):
            found = [form.format(axis) for axis in axes]
            if form == "{}" and axes == "123":
                continue
            if all(name in names for name in found):
                a, b, c = (names.index(name) for name in found)
                return a, b, c
    return None


def _quaternion(
    names: Sequence[str], asked: Order | None, usual: Order, where: str
) -> tuple[tuple[int, int, int, int] | None, Order]:
    for form in _QUATERNION:
        for digits, named in (("wxyz", True), ("0123", True), ("1234", False), ("sxyz", True)):
            found = [form.format(digit) for digit in digits]
            if (form == "{}" and digits != "wxyz") or not all(name in names for name in found):
                continue
            if form == "{}" and _position_is_bare(names):
                continue
            a, b, c, d = (names.index(name) for name in found)
            if named and asked not in (None, "wxyz" if a < b else "xyzw"):
                shown = ", ".join(sorted(found, key=names.index))
                raise InputError(f"{where}: the header names {shown}; --quaternion-order {asked} contradicts it")
            return (a, b, c, d), "wxyz" if named else asked or usual
    return None, usual


def _position_is_bare(names: Sequence[str]) -> bool:
    """Whether x, y, z can only be the position: bare w, x, y, z beside it is a quaternion."""
    return not any(form.format("x") in names for form in _POSITION if form != "{}")


def _lacking(header: Sequence[str], filename: object, position: object, quaternion: object) -> str:
    wanted = {"filename": filename, "a position (Tx,Ty,Tz)": position, "a quaternion (Qw,Qx,Qy,Qz)": quaternion}
    missing = " and ".join(name for name, found in wanted.items() if found is None)
    return f"the header names no column for {missing}; found {', '.join(header)[:160]}"


@dataclass(frozen=True, slots=True)
class NamedPose:
    """One row of a table with a header."""

    filename: str
    part: str
    """Sequence, category or the like; empty without such a column."""
    T_cam_target: Pose | None
    where: str
    """The row, for messages."""
    status: str = "ok"
    """Why there is no pose."""


def named_poses(rows: Sequence[Sequence[str]], asked: Order | None, usual: Order, path: Path) -> list[NamedPose]:
    """The rows below a header."""
    columns = pose_columns(rows[0], asked, usual, str(path))
    reason = next((k for k, cell in enumerate(rows[0]) if cell.lower() == "status"), None)
    found = []
    for number, row in enumerate(rows[1:], 1):
        where = f"{path}, pose {number}"
        check_width(row, columns.width, where, ",".join(rows[0])[:160])
        part = "" if columns.part is None else row[columns.part]
        name, status = checked_name(row[columns.filename], where), "ok" if reason is None else row[reason] or "ok"
        if reason is not None and not any(row[k] for k in (*columns.position, *columns.quaternion)):
            found.append(NamedPose(name, part, None, where, "no_pose" if status == "ok" else status))
        else:
            found.append(NamedPose(name, part, columns.pose(row, where), where, status))
    return found
