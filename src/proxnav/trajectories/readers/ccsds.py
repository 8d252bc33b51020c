"""CCSDS orbit (OEM) and attitude (AEM) ephemeris messages in KVN, and the CNES CIC variants with times as MJD, seconds.

CCSDS 502.0-B and 504.0-B: kilometres; attitudes from REF_FRAME_A to REF_FRAME_B or back, as ATTITUDE_DIR says.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from proxnav.errors import InputError
from proxnav.geometry.epochs import Instant, parse_iso
from proxnav.trajectories.readers.history import AttitudeHistory, Method, OrbitHistory, Segment, Series
from proxnav.trajectories.readers.reference_frames import ORBITAL, ReferenceFrame, frame_kind
from proxnav.trajectories.readers.text import check_times, check_unit_quaternions, fail, number, read_lines

QuaternionOrder = Literal["wxyz", "xyzw"]

_STATE_SIZES = (3, 6, 9)
_QUATERNION_SIZES = {"quaternion": 4, "quaternion/derivative": 8, "quaternion/rate": 7, "quaternion/angvel": 7}
_KEYWORD = re.compile(r"([A-Z0-9_]+)\s*=\s*(.*)")


@dataclass(slots=True)
class _Block:
    """One META section and the rows that follow it."""

    line: int
    meta: dict[str, str] = field(default_factory=dict)
    rows: list[tuple[int, Instant, list[float]]] = field(default_factory=list)


def read_oem(path: str | Path) -> tuple[OrbitHistory, ...]:
    """One history per object; every META section is a segment of its own."""
    blocks = _read_blocks(path, "OEM")
    return tuple(_orbit(path, name, group) for name, group in _by_object(blocks).items())


def read_aem(path: str | Path, order: QuaternionOrder | None = None) -> tuple[AttitudeHistory, ...]:
    """One history per object; `order` is used where the file does not declare the place of the scalar."""
    blocks = _read_blocks(path, "AEM")
    version = next(block.meta["_version"] for block in blocks)
    return tuple(_attitude(path, name, group, version, order) for name, group in _by_object(blocks).items())


def _orbit(path: str | Path, name: str, blocks: list[_Block]) -> OrbitHistory:
    epoch = blocks[0].rows[0][1]
    segments = []
    for block in blocks:
        t, values = _series(path, block, epoch)
        if values.shape[1] not in _STATE_SIZES:
            fail(path, block.rows[0][0], f"a state needs 3, 6 or 9 numbers after the epoch, found {values.shape[1]}")
        r_km, v_kms = values[:, :3], values[:, 3:6] if values.shape[1] >= 6 else None
        segments.append(Segment(t, 1e3 * r_km, None if v_kms is None else 1e3 * v_kms))
    method, nodes = _interpolation(path, blocks[0], segments[0].rates is not None)
    return OrbitHistory(name, str(path), epoch, _frame(path, blocks, "REF_FRAME"), tuple(segments), method, nodes)


def _attitude(
    path: str | Path, name: str, blocks: list[_Block], version: str, order: QuaternionOrder | None
) -> AttitudeHistory:
    epoch = blocks[0].rows[0][1]
    external = "REF_FRAME_A" if frame_kind(blocks[0].meta.get("REF_FRAME_A", "")) else "REF_FRAME_B"
    outward = (external == "REF_FRAME_A") == (_need(path, blocks[0], "ATTITUDE_DIR").upper() == "A2B")
    segments = []
    for block in blocks:
        t, values = _series(path, block, epoch)
        turn = _rotations(path, block, values, version, order)
        q = (turn if outward else turn.inv()).as_quat(scalar_first=True)
        segments.append(Segment(t, q))
    degree = int(blocks[0].meta.get("INTERPOLATION_DEGREE", "1"))
    linear = blocks[0].meta.get("INTERPOLATION_METHOD", "LINEAR").upper() == "LINEAR"
    nodes = 2 if linear else max(degree, 1) + 1
    return AttitudeHistory(name, str(path), epoch, _frame(path, blocks, external), tuple(segments), nodes)


def _rotations(
    path: str | Path, block: _Block, values: Float[np.ndarray, "n k"], version: str, order: QuaternionOrder | None
) -> Rotation:
    """Rotations that turn vectors of the destination axes into vectors of the origin's."""
    kind = block.meta.get("ATTITUDE_TYPE", "QUATERNION").lower()
    if kind == "euler_angle":
        digits = _need(path, block, "EULER_ROT_SEQ").upper()
        axes = digits.translate(str.maketrans("123", "XYZ"))
        if len(axes) != 3 or not set(axes) <= set("XYZ") or values.shape[1] != 3:
            fail(path, block.line, f"EULER_ROT_SEQ '{digits}' needs three axes and three angles per row")
        return Rotation.from_euler(axes, values, degrees=True)
    if kind not in _QUATERNION_SIZES:
        fail(path, block.line, f"ATTITUDE_TYPE {kind.upper()} is not supported; export quaternions")
    for line, _, numbers in block.rows:
        if len(numbers) != _QUATERNION_SIZES[kind]:
            fail(path, line, f"{kind.upper()} needs {_QUATERNION_SIZES[kind]} numbers after the epoch")
    check_unit_quaternions(values[:, :4], [line for line, _, _ in block.rows], path)
    return Rotation.from_quat(values[:, :4], scalar_first=_scalar_first(path, block, version, order))


def _scalar_first(path: str | Path, block: _Block, version: str, order: QuaternionOrder | None) -> bool:
    declared = block.meta.get("QUATERNION_TYPE", "").upper()
    if declared in ("FIRST", "LAST"):
        return declared == "FIRST"
    if order is not None:
        return order == "wxyz"
    if version.startswith("1"):
        fail(path, block.line, "QUATERNION_TYPE is missing; add it, or say quaternion_order wxyz or xyzw")
    return False  # version 2: always last


def _interpolation(path: str | Path, block: _Block, with_velocity: bool) -> tuple[Method, int]:
    """(method, nodes); where nothing is declared, Hermite of degree 7 with velocities, Lagrange of degree 5 without."""
    name = block.meta.get("INTERPOLATION", "").upper()
    if name not in ("", "HERMITE", "LAGRANGE", "LINEAR"):
        fail(path, block.line, f"unknown INTERPOLATION '{name}'; use HERMITE, LAGRANGE or LINEAR")
    degree = int(number(block.meta.get("INTERPOLATION_DEGREE", "0"), path, block.line, "a degree"))
    if name == "LINEAR":
        return "lagrange", 2
    if name == "LAGRANGE" or not with_velocity:
        return "lagrange", (degree or 5) + 1
    return "hermite", max(((degree or 7) + 1) // 2, 2)


def _series(path: str | Path, block: _Block, epoch: Instant) -> tuple[Series, Float[np.ndarray, "n k"]]:
    t = [moment - epoch for _, moment, _ in block.rows]
    lines = [line for line, _, _ in block.rows]
    check_times(t, lines, path)
    repeated = np.flatnonzero(np.diff(t) == 0.0)
    if repeated.size:
        fail(path, lines[repeated[0] + 1], "two rows share one epoch; start a new META section at a manoeuvre")
    sizes = {len(numbers) for _, _, numbers in block.rows}
    if len(sizes) > 1:
        common = len(block.rows[0][2])
        line = next(line for line, _, numbers in block.rows if len(numbers) != common)
        fail(path, line, f"expected {common} numbers after the epoch as in the rows before; the line may be cut off")
    _check_stop(path, block)
    return np.array(t), np.array([numbers for _, _, numbers in block.rows])


def _check_stop(path: str | Path, block: _Block) -> None:
    if "STOP_TIME" not in block.meta:
        return
    try:
        stop = _moment(block.meta["STOP_TIME"].split())
    except (InputError, ValueError):
        fail(path, block.line, f"STOP_TIME '{block.meta['STOP_TIME']}' is no epoch; write 2024-11-01T00:00:00")
    last_line, last, _ = block.rows[-1]
    if stop - last > 1e-3:
        fail(path, last_line, f"data end {stop - last:g} s before STOP_TIME: the file is cut off; export it again")


def _frame(path: str | Path, blocks: list[_Block], keyword: str) -> ReferenceFrame:
    names = {_need(path, block, keyword) for block in blocks}
    kind = frame_kind(sorted(names)[0])
    if len(names) > 1 or kind is None or kind == "of_epoch" or (kind in ORBITAL and keyword == "REF_FRAME"):
        fail(path, blocks[0].line, f"{keyword} {', '.join(sorted(names))} is not supported; use EME2000, ICRF or ITRF")
    return ReferenceFrame(kind)


def _by_object(blocks: list[_Block]) -> dict[str, list[_Block]]:
    groups: dict[str, list[_Block]] = {}
    for block in blocks:
        groups.setdefault(block.meta.get("OBJECT_NAME", ""), []).append(block)
    return groups


def _need(path: str | Path, block: _Block, keyword: str) -> str:
    if keyword not in block.meta:
        fail(path, block.line, f"{keyword} is missing in this META section; add it")
    return block.meta[keyword]


def _read_blocks(path: str | Path, kind: str) -> list[_Block]:
    blocks: list[_Block] = []
    version, inside = "", ""
    for count, raw in enumerate(read_lines(path), start=1):
        line = raw.strip()
        if not line or line.startswith("COMMENT"):
            continue
        if line.endswith("_START") or line.endswith("_STOP"):
            inside = _enter(path, count, line, inside, blocks, version)
        elif match := _KEYWORD.fullmatch(line):
            if match[1] in (f"CCSDS_{kind}_VERS", f"CIC_{kind}_VERS"):
                version = match[2].strip()
            elif inside == "META":
                blocks[-1].meta[match[1]] = match[2].strip()
        elif inside not in ("META", "COVARIANCE"):
            if not blocks:
                fail(path, count, "data before the first META section; the file's head is missing")
            blocks[-1].rows.append(_row(path, count, line.split()))
    if not version:
        raise InputError(f"{path}: CCSDS_{kind}_VERS is missing: it is no {kind} file in KVN")
    if inside or not blocks:
        raise InputError(f"{path}: {inside or 'META'}_{'STOP' if inside else 'START'} is missing: the file is cut off")
    return _checked(path, blocks)


def _enter(path: str | Path, count: int, line: str, inside: str, blocks: list[_Block], version: str) -> str:
    name, _, flag = line.rpartition("_")
    if flag == "STOP":
        if name != inside:
            fail(path, count, f"{line} without {name}_START; the file is damaged")
        return ""
    if inside:
        fail(path, count, f"{line} before {inside}_STOP; the file is damaged")
    if name == "META":
        blocks.append(_Block(count, {"_version": version}))
    return name


def _row(path: str | Path, count: int, tokens: list[str]) -> tuple[int, Instant, list[float]]:
    width = 2 if re.fullmatch(r"\d{5}", tokens[0]) else 1  # CIC: MJD and seconds of the day
    try:
        moment = _moment(tokens[:width])
    except (InputError, ValueError):
        fail(path, count, f"'{' '.join(tokens[:width])}' is no epoch; expected one such as 2024-11-01T00:00:00")
    return count, moment, [number(token, path, count) for token in tokens[width:]]


def _moment(tokens: list[str]) -> Instant:
    if len(tokens) == 2:
        return Instant(int(tokens[0]), 0.0).plus(float(tokens[1]))
    return parse_iso(tokens[0])


def _checked(path: str | Path, blocks: list[_Block]) -> list[_Block]:
    for block in blocks:
        system = block.meta.get("TIME_SYSTEM", "UTC").upper()
        if system != "UTC":
            fail(path, block.line, f"TIME_SYSTEM is {system}, only UTC is supported; export in UTC")
        if block.meta.get("CENTER_NAME", "EARTH").upper() not in ("EARTH", "EARTH BARYCENTER", "399"):
            fail(path, block.line, f"CENTER_NAME is {block.meta['CENTER_NAME']}, only EARTH is supported")
        if not block.rows:
            fail(path, block.line, "no data rows follow this META section; the file is cut off")
    return blocks
