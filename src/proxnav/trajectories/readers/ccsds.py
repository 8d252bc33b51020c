"""CCSDS orbit (OEM) and attitude (AEM) ephemeris messages, in KVN or XML, and the CNES CIC variants.

CCSDS 502.0-B and 504.0-B: kilometres; attitudes from REF_FRAME_A to REF_FRAME_B, in version 1 also back, as
ATTITUDE_DIR says. Version 2 of AEM has neither ATTITUDE_DIR nor QUATERNION_TYPE: always from A to B, the scalar last.
"""

from pathlib import Path
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from proxnav.errors import InputError
from proxnav.geometry.epochs import Instant
from proxnav.trajectories.readers.ccsds_sections import MetaSection, checked, need, parse_epoch, read_kvn
from proxnav.trajectories.readers.ccsds_xml import read_xml
from proxnav.trajectories.readers.history import AttitudeHistory, Method, OrbitHistory, Segment, Series
from proxnav.trajectories.readers.reference_frames import ORBITAL, ReferenceFrame, frame_kind
from proxnav.trajectories.readers.text import check_times, check_unit_quaternions, fail, is_xml, number
from proxnav.trajectories.time_systems import to_utc

QuaternionOrder = Literal["wxyz", "xyzw"]

_STATE_SIZES = (3, 6, 9)
_QUATERNION_SIZES = {"quaternion": 4, "quaternion/derivative": 8, "quaternion/rate": 7, "quaternion/angvel": 7}


def read_oem(path: str | Path) -> tuple[OrbitHistory, ...]:
    """One history per object; every META section is a segment of its own."""
    sections = _sections(path, "OEM")
    return tuple(_orbit(path, name, group) for name, group in _by_object(sections).items())


def read_aem(path: str | Path, order: QuaternionOrder | None = None) -> tuple[AttitudeHistory, ...]:
    """One history per object; `order` is used where the file does not declare the place of the scalar."""
    groups = _by_object(_sections(path, "AEM"))
    return tuple(_attitude(path, name, group, order) for name, group in groups.items())


def _sections(path: str | Path, kind: str) -> list[MetaSection]:
    sections = checked(path, read_xml(path, kind) if is_xml(path) else read_kvn(path, kind))
    systems = {section.time_system for section in sections}
    if len(systems) > 1:
        fail(path, sections[0].line, f"epochs in {' and '.join(sorted(systems))}: export all META sections in UTC")
    return sections


def _orbit(path: str | Path, name: str, sections: list[MetaSection]) -> OrbitHistory:
    epoch = sections[0].rows[0][1]
    segments = []
    for section in sections:
        t, values = _series(path, section, epoch)
        if values.shape[1] not in _STATE_SIZES:
            fail(path, section.rows[0][0], f"a state needs 3, 6 or 9 numbers after the epoch, found {values.shape[1]}")
        r_km, v_kms = values[:, :3], values[:, 3:6] if values.shape[1] >= 6 else None
        segments.append(Segment(t, 1e3 * r_km, None if v_kms is None else 1e3 * v_kms))
    method, nodes = _interpolation(path, sections[0], segments[0].rates is not None)
    utc, frame = to_utc(epoch, sections[0].time_system), _frame(path, sections, "REF_FRAME")
    unused = sum(section.covariances for section in sections)
    note = f"its {unused} covariance matrices are not used" if unused else ""
    return OrbitHistory(name, str(path), utc, frame, tuple(segments), method, nodes, note)


def _attitude(
    path: str | Path, name: str, sections: list[MetaSection], order: QuaternionOrder | None
) -> AttitudeHistory:
    epoch = sections[0].rows[0][1]
    external = "REF_FRAME_A" if frame_kind(sections[0].meta.get("REF_FRAME_A", "")) else "REF_FRAME_B"
    outward = (external == "REF_FRAME_A") == (_direction(path, sections[0]) == "A2B")
    segments = []
    for section in sections:
        t, values = _series(path, section, epoch)
        turn = _rotations(path, section, values, order)
        q = (turn if outward else turn.inv()).as_quat(scalar_first=True)
        segments.append(Segment(t, q))
    degree = int(number(sections[0].meta.get("INTERPOLATION_DEGREE", "1"), path, sections[0].line, "a degree"))
    linear = sections[0].meta.get("INTERPOLATION_METHOD", "LINEAR").upper() == "LINEAR"
    nodes = 2 if linear else max(degree, 1) + 1
    utc = to_utc(epoch, sections[0].time_system)
    return AttitudeHistory(name, str(path), utc, _frame(path, sections, external), tuple(segments), nodes)


def _direction(path: str | Path, section: MetaSection) -> str:
    if section.version.startswith("1"):
        return need(path, section, "ATTITUDE_DIR").upper()
    return section.meta.get("ATTITUDE_DIR", "A2B").upper()


def _rotations(
    path: str | Path, section: MetaSection, values: Float[np.ndarray, "n k"], order: QuaternionOrder | None
) -> Rotation:
    """Rotations that turn vectors of the destination axes into vectors of the origin's."""
    kind = section.meta.get("ATTITUDE_TYPE", "QUATERNION").lower()
    if kind == "euler_angle":
        digits = need(path, section, "EULER_ROT_SEQ").upper()
        axes = digits.translate(str.maketrans("123", "XYZ"))
        if len(axes) != 3 or not set(axes) <= set("XYZ") or values.shape[1] != 3:
            fail(path, section.line, f"EULER_ROT_SEQ '{digits}' needs three axes and three angles per row")
        return Rotation.from_euler(axes, values, degrees=True)
    if kind not in _QUATERNION_SIZES:
        fail(path, section.line, f"ATTITUDE_TYPE {kind.upper()} is not supported; export quaternions")
    for line, _, numbers in section.rows:
        if len(numbers) != _QUATERNION_SIZES[kind]:
            fail(path, line, f"{kind.upper()} needs {_QUATERNION_SIZES[kind]} numbers after the epoch")
    check_unit_quaternions(values[:, :4], [line for line, _, _ in section.rows], path)
    return Rotation.from_quat(values[:, :4], scalar_first=_scalar_first(path, section, order))


def _scalar_first(path: str | Path, section: MetaSection, order: QuaternionOrder | None) -> bool:
    declared = section.meta.get("QUATERNION_TYPE", "").upper()
    if declared in ("FIRST", "LAST"):
        return declared == "FIRST"
    if order is not None:
        return order == "wxyz"
    if section.version.startswith("1"):
        fail(path, section.line, "QUATERNION_TYPE is missing; add it, or say --reader.quaternion-order wxyz or xyzw")
    return False  # version 2: always last


def _interpolation(path: str | Path, section: MetaSection, with_velocity: bool) -> tuple[Method, int]:
    """(method, nodes); where nothing is declared, Hermite of degree 7 with velocities, Lagrange of degree 5 without."""
    name = section.meta.get("INTERPOLATION", "").upper()
    if name not in ("", "HERMITE", "LAGRANGE", "LINEAR"):
        fail(path, section.line, f"unknown INTERPOLATION '{name}'; use HERMITE, LAGRANGE or LINEAR")
    degree = int(number(section.meta.get("INTERPOLATION_DEGREE", "0"), path, section.line, "a degree"))
    if name == "LINEAR":
        return "lagrange", 2
    if name == "LAGRANGE" or not with_velocity:
        return "lagrange", (degree or 5) + 1
    return "hermite", max(((degree or 7) + 1) // 2, 2)


def _series(path: str | Path, section: MetaSection, epoch: Instant) -> tuple[Series, Float[np.ndarray, "n k"]]:
    t = [moment - epoch for _, moment, _ in section.rows]
    lines = [line for line, _, _ in section.rows]
    check_times(t, lines, path)
    repeated = np.flatnonzero(np.diff(t) == 0.0)
    if repeated.size:
        fail(path, lines[repeated[0] + 1], "two rows share one epoch; start a new META section at a manoeuvre")
    sizes = {len(numbers) for _, _, numbers in section.rows}
    if len(sizes) > 1:
        common = len(section.rows[0][2])
        line = next(line for line, _, numbers in section.rows if len(numbers) != common)
        fail(path, line, f"expected {common} numbers after the epoch as in the rows before; the line may be cut off")
    _check_stop(path, section)
    return np.array(t), np.array([numbers for _, _, numbers in section.rows])


def _check_stop(path: str | Path, section: MetaSection) -> None:
    if "STOP_TIME" not in section.meta:
        return
    try:
        stop = parse_epoch(section.meta["STOP_TIME"].split())
    except (InputError, ValueError):
        fail(path, section.line, f"STOP_TIME '{section.meta['STOP_TIME']}' is no epoch; write 2024-11-01T00:00:00")
    last_line, last, _ = section.rows[-1]
    if stop - last > 1e-3:
        fail(path, last_line, f"data end {stop - last:g} s before STOP_TIME: the file is cut off; export it again")


def _frame(path: str | Path, sections: list[MetaSection], keyword: str) -> ReferenceFrame:
    names = {need(path, section, keyword) for section in sections}
    kind = frame_kind(sorted(names)[0])
    if len(names) > 1 or kind is None or ReferenceFrame(kind).is_frozen or (kind in ORBITAL and keyword == "REF_FRAME"):
        fail(
            path, sections[0].line, f"{keyword} {', '.join(sorted(names))} is not supported; use EME2000, ICRF or ITRF"
        )
    return ReferenceFrame(kind)


def _by_object(sections: list[MetaSection]) -> dict[str, list[MetaSection]]:
    groups: dict[str, list[MetaSection]] = {}
    for section in sections:
        groups.setdefault(section.meta.get("OBJECT_NAME", ""), []).append(section)
    return groups
