"""STK attitude files (.a). They describe reference axes -> body axes; read as q_frame_body, which turns body vectors
into reference vectors.

Euler angles turn about axes that moved with the earlier turns; STK's yaw, pitch and roll are about the axes of the
reference frame (AGI help, "AddAttitude ECIYPR"), in the order of `Sequence`, the columns always yaw, pitch, roll.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from proxnav.errors import InputError
from proxnav.geometry.epochs import Instant
from proxnav.geometry.types import QuatWxyz
from proxnav.trajectories.readers.dates import parse_date
from proxnav.trajectories.readers.history import AttitudeHistory, Segment, rate_note, split
from proxnav.trajectories.readers.stk_file import Row, StkFile, data_rows, read_stk, reference_frame, scenario_epoch
from proxnav.trajectories.readers.text import check_times, check_unit_quaternions, fail, number, numbers

_COLUMNS = {
    "attitudetimequaternions": 4,
    "attitudetimequatscalarfirst": 4,
    "attitudetimequatangvels": 7,
    "attitudetimeeulerangles": 3,
    "attitudetimeyprangles": 3,
    "attitudetimedcm": 9,
    "attitudetimeecivector": 3,
    "attitudetimeecfvector": 3,
}
_TIME_TOKENS = {"epsec": 1, "utcg": 4, "iso-ymd": 1}
_AXES = {"1": "x", "2": "y", "3": "z"}


def read_stk_attitude(path: str | Path, scalar_first: bool | None = None) -> AttitudeHistory:
    """Attitudes as the file declares them; `scalar_first` overrides the block's order for writers that ignore it."""
    file = read_stk(path, "attitude", set(_COLUMNS))
    block, rows = data_rows(file, set(_COLUMNS), "numberofattitudepoints")
    if block.endswith("vector"):
        raise InputError(
            f"{path}: {block} gives one direction, which leaves the turn about it open; export quaternions instead"
        )
    epoch = scenario_epoch(file)
    t = np.array([_time(file, row, epoch) for row in rows])
    check_times(t.tolist(), [row.line for row in rows], path)
    skip, count = _time_tokens(file), _COLUMNS[block]
    values = [numbers(row.tokens[skip:], count, path, row.line, f"a row of {block} after its time") for row in rows]
    q = _attitudes(file, block, rows, np.array(values), scalar_first)
    segments = tuple(Segment(t[piece], q[piece]) for piece in split(t, np.empty(0)))
    frame = reference_frame(file, "coordinateaxes", "J2000")
    nodes = max(file.integer("interpolationorder", 1), 1) + 1
    note = rate_note(t, q, np.deg2rad(np.array(values)[:, 4:])) if block == "attitudetimequatangvels" else ""
    return AttitudeHistory(Path(path).stem, str(path), epoch, frame, segments, nodes, note)


def _attitudes(
    file: StkFile, block: str, rows: list[Row], values: Float[np.ndarray, "n k"], scalar_first: bool | None
) -> QuatWxyz:
    """q_frame_body, wxyz."""
    if "quat" in block:
        first = block == "attitudetimequatscalarfirst" if scalar_first is None else scalar_first
        check_unit_quaternions(values[:, :4], [row.line for row in rows], file.path)
        return Rotation.from_quat(values[:, :4], scalar_first=first).as_quat(scalar_first=True)
    if block == "attitudetimedcm":
        return _from_dcm(file.path, rows, values.reshape(-1, 3, 3))
    yaw_pitch_roll = block == "attitudetimeyprangles"
    axes = _sequence(file, "321" if yaw_pitch_roll else "313")
    if yaw_pitch_roll:
        angles = values[:, ["zyx".index(axis) for axis in axes]]
        return Rotation.from_euler(axes, angles, degrees=True).as_quat(scalar_first=True)
    return Rotation.from_euler(axes.upper(), values, degrees=True).as_quat(scalar_first=True)


def _from_dcm(path: str, rows: list[Row], dcm: Float[np.ndarray, "n 3 3"]) -> QuatWxyz:
    """The rows of each matrix are the body axes in the reference frame: it maps reference to body."""
    departure = np.abs(dcm @ np.swapaxes(dcm, 1, 2) - np.eye(3)).max(axis=(1, 2))
    wrong = (departure > 2e-3) | (np.linalg.det(dcm) < 0.0)
    if wrong.any():
        fail(path, rows[int(np.argmax(wrong))].line, "the 9 numbers are no rotation matrix; check their order")
    return Rotation.from_matrix(np.swapaxes(dcm, 1, 2)).as_quat(scalar_first=True)


def _sequence(file: StkFile, default: str) -> str:
    line, digits = file.keywords.get("sequence", (0, default))
    axes = "".join(_AXES.get(digit, "?") for digit in digits)
    repeats = any(a == b for a, b in pairwise(axes))
    if len(axes) != 3 or "?" in axes or repeats or (default == "321" and len(set(axes)) < 3):
        fail(file.path, line, f"Sequence '{digits}' is no sequence of three turns; use one such as {default}")
    return axes


def _time_tokens(file: StkFile) -> int:
    line, name = file.keywords.get("timeformat", (0, "EpSec"))
    if name.lower() not in _TIME_TOKENS:
        fail(file.path, line, f"unknown TimeFormat '{name}'; use EpSec, UTCG or ISO-YMD")
    return _TIME_TOKENS[name.lower()]


def _time(file: StkFile, row: Row, epoch: Instant) -> float:
    """Seconds past ScenarioEpoch."""
    count = _time_tokens(file)
    text = " ".join(row.tokens[:count])
    if file.text("timeformat", "EpSec").lower() == "epsec":
        return number(text, file.path, row.line, "seconds past ScenarioEpoch")
    try:
        return parse_date(text) - epoch
    except InputError as error:
        fail(file.path, row.line, str(error))
