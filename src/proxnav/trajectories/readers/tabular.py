"""Tables as histories: units and quaternion order from the headers, demanded from the user where these are silent."""

from pathlib import Path

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.epochs import Instant
from proxnav.trajectories.readers.columns import TRIADS, Column, understand
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.history import (
    AttitudeHistory,
    History,
    OrbitHistory,
    Segment,
    Series,
    rate_note,
    split,
)
from proxnav.trajectories.readers.reference_frames import (
    AXES,
    FRAME_NAMES,
    ORBITAL,
    FrameKind,
    ReferenceFrame,
    frame_kind,
    ric_from_lvlh,
)
from proxnav.trajectories.readers.table_cells import cells_of, lengths_or_speeds
from proxnav.trajectories.readers.table_times import times_of
from proxnav.trajectories.readers.text import check_times, check_unit_quaternions
from proxnav.trajectories.readers.text_table import TextTable

_QUATERNION = ("qw", "qx", "qy", "qz", "q1", "q2", "q3", "q4")


def histories(table: TextTable, config: ReaderConfig) -> list[History]:
    """Orbits and attitudes of every object in the table."""
    columns = understand(table.headers)
    if not any(column.meaning not in ("", "t") for column in columns):
        raise _nothing_known(table)
    epoch, t = times_of(table, columns, config)
    check_times(t.tolist(), [line for line, _ in table.rows], table.path)
    found: list[History] = []
    for owner in dict.fromkeys(column.owner for column in columns if column.meaning not in ("", "t")):
        mine = {c.meaning: c for c in columns if c.owner == owner and c.meaning not in ("", "t")}
        name = owner or table.object_name or Path(table.path).stem
        if any(set(triad.places) <= set(mine) for triad in TRIADS):
            found.append(_orbit(table, config, name, epoch, t, mine))
        if {"q1", "q2", "q3", "q4"} <= set(mine) or {"qw", "qx", "qy", "qz"} <= set(mine) or "qw" in mine:
            found.append(_attitude(table, config, name, epoch, t, mine))
    if not found:
        raise _nothing_known(table)
    return found


def _nothing_known(table: TextTable) -> InputError:
    return InputError(
        f"{table.path}: no position nor quaternion among the columns {', '.join(table.headers)}; rename them, or name "
        "all with --reader.columns: t and x y z, radial in-track cross-track, vbar hbar rbar, or qw qx qy qz"
    )


def _orbit(
    table: TextTable, config: ReaderConfig, name: str, epoch: Instant, t: Series, mine: dict[str, Column]
) -> OrbitHistory:
    triad = next(triad for triad in TRIADS if set(triad.places) <= set(mine))
    frame = _frame(table, config, {key: mine[key] for key in triad.places}, triad.frame)
    unsaid = 1.0 if frame.kind in ORBITAL else None  # near a target nobody counts in anything but metres
    r = np.stack([lengths_or_speeds(table, mine[key], config, unsaid) for key in triad.places], axis=-1)
    v = None
    if set(triad.speeds) <= set(mine):
        v = np.stack([lengths_or_speeds(table, mine[key], config, unsaid) for key in triad.speeds], axis=-1)
    note = ""
    if frame.kind in ORBITAL:
        is_silent = not mine[triad.places[0]].unit and config.position_unit is None
        note = f"read as {AXES[frame.kind]}" + (", in metres, which the file does not say" if is_silent else "")
    if frame.kind == "lvlh":
        r, v = ric_from_lvlh(r), None if v is None else ric_from_lvlh(v)
        frame = ReferenceFrame("ric")
    segments = tuple(Segment(t[p], r[p], None if v is None else v[p]) for p in split(t, np.empty(0)))
    method, nodes = ("lagrange", 6) if v is None else ("hermite", 4)
    return OrbitHistory(name, table.path, epoch, frame, segments, method, nodes, note)


def _attitude(
    table: TextTable, config: ReaderConfig, name: str, epoch: Instant, t: Series, mine: dict[str, Column]
) -> AttitudeHistory:
    q = np.stack([cells_of(table, mine[key]) for key in _quaternion_columns(table, config, mine)], axis=-1)
    check_unit_quaternions(q, [line for line, _ in table.rows], table.path)
    q = quaternion.normalize(q)
    if config.quaternion_direction == "body_to_reference":
        q = quaternion.conjugate(q)
    segments = tuple(Segment(t[p], q[p]) for p in split(t, np.empty(0)))
    note = ""
    if {"wx", "wy", "wz"} <= set(mine) and all(mine[key].factor for key in ("wx", "wy", "wz")):
        rates = [mine[key].factor * cells_of(table, mine[key]) for key in ("wx", "wy", "wz")]  # pyright: ignore
        note = rate_note(t, q, np.stack(rates, axis=-1))
    others = {meaning for triad in TRIADS if triad.frame for meaning in (*triad.places, *triad.speeds)}
    own = {k: c for k, c in mine.items() if k not in others and (k in _QUATERNION or c.frame not in ORBITAL)}
    return AttitudeHistory(name, table.path, epoch, _frame(table, config, own, None), segments, note=note)


def _quaternion_columns(table: TextTable, config: ReaderConfig, mine: dict[str, Column]) -> tuple[str, ...]:
    """Columns in the order w, x, y, z. Letters and Euler parameters say it; q1 to q4 do so in STK's reports only."""
    if {"qw", "qx", "qy", "qz"} <= set(mine):
        return ("qw", "qx", "qy", "qz")
    if {"qw", "q1", "q2", "q3"} <= set(mine):
        return ("qw", "q1", "q2", "q3")
    order = config.quaternion_order or ("xyzw" if table.style else None)
    if order is None:
        raise InputError(
            f"{table.path}: columns q1 to q4 do not say where the scalar is; say --reader.quaternion-order wxyz "
            "(MATLAB's Aerospace Toolbox) or xyzw (STK)"
        )
    return ("q1", "q2", "q3", "q4") if order == "wxyz" else ("q4", "q1", "q2", "q3")


def _frame(
    table: TextTable, config: ReaderConfig, mine: dict[str, Column], by_name: FrameKind | None
) -> ReferenceFrame:
    """By the columns' names, the option, the report's title or the headers: Basilisk writes ECI into its headers.

    The option is for tables that do not say; among axes at Earth's centre it has the last word.
    """
    asked = frame_kind(config.frame) if config.frame else None
    if config.frame and (asked is None or ReferenceFrame(asked).is_frozen):
        raise InputError(f"--reader.frame {config.frame} is unknown; use {FRAME_NAMES}")
    named = by_name or _named_frame(table, mine)
    if named in ORBITAL and asked in ORBITAL and asked != named:
        names = ", ".join(column.header for column in mine.values())
        said = f"--reader.frame says {config.frame}; leave it out or rename the columns"
        raise InputError(f"{table.path}: {names} are {AXES[named]} by name, {said}")
    if asked is not None and not (named and (named in ORBITAL or asked in ORBITAL)):
        return ReferenceFrame(asked)
    if named is not None:
        return ReferenceFrame(named)
    columns = ", ".join(column.header for column in mine.values())
    raise InputError(
        f"{table.path}: the file does not say the axes of {columns}; relative to the target say --reader.frame RIC "
        "(x radial outward, y in-track, z along r x v) or LVLH (x ahead, z to nadir), at Earth's centre ICRF, J2000 or "
        "Fixed, there with --reader.position-unit where the header has none"
    )


def _named_frame(table: TextTable, mine: dict[str, Column]) -> FrameKind | None:
    """Axes in the headers or in the title of a report."""
    in_headers: list[FrameKind | None] = [column.frame for column in mine.values()]
    words = [*table.style.split(), *(c.header.split()[0] for c in mine.values() if c.header.split())]
    in_words: list[FrameKind | None] = [kind for kind in map(frame_kind, words) if kind not in ORBITAL]
    return next((kind for kind in (*in_headers, *in_words) if kind is not None), None)
