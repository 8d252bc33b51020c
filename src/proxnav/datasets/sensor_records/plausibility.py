"""Records that cannot be: rows to leave out, and files in the wrong unit."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import MU_EARTH
from proxnav.records import EphemerisData, SensorRecords

Rows = Float[np.ndarray, "n n_columns"]
"""Values of a table, row by row."""
_ORBIT_STEP_S = 20.0  # s between the rows that are compared, at least: noise of single rows counts less
_MOST_CHORD_ERROR = 0.02
_MOST_PULL_ERROR = 0.05
_LEAST_TURN = 3e-4  # rad/s; below it gyro and star tracker have nothing to be compared by


@dataclass(frozen=True)
class Range:
    """Where the length of a block of columns (x, y, z) lies in any real record."""

    low: float
    high: float
    unit: str
    row: float = 20.0
    """A single row may exceed `high` by this factor before it is left out: noise is no reason."""


def check_table(
    path: str, columns: Sequence[str], rows: Rows, ranges: Mapping[str, Range]
) -> tuple[Float[np.ndarray, "n_kept n_columns"], dict[str, int]]:
    """Rows that can be, and how many were left out for which reason; InputError when the whole file cannot be."""
    finite = np.isfinite(rows).all(axis=1)
    reasons = {"not finite": int((~finite).sum())}
    rows = rows[finite]
    if len(rows) == 0:
        raise InputError(f"{path}: holds no row of finite numbers; expected columns {', '.join(columns)}")
    keep = np.ones(len(rows), dtype=bool)
    for prefix, limits in ranges.items():
        keep &= _inside(path, columns, rows, prefix, limits)
    reasons["implausible"] = int((~keep).sum())
    return rows[keep], {reason: count for reason, count in reasons.items() if count}


def _inside(path: str, columns: Sequence[str], rows: Rows, prefix: str, limits: Range) -> Bool[np.ndarray, "n"]:
    """Which rows can be; a median out of range is a unit, not noise."""
    block = [i for i, name in enumerate(columns) if name.startswith(prefix)]
    length = np.linalg.norm(rows[:, block], axis=1)
    middle = float(np.median(length))
    if not limits.low <= middle <= limits.high:
        raise InputError(
            f"{path}: the median of {columns[block[0]]} and its like is {middle:.3g} {limits.unit}, expected "
            f"{limits.low:g} to {limits.high:g}: check the unit of the column"
        )
    if limits.unit == "(norm)":
        return (length > 0.9) & (length < 1.1)
    return length <= limits.high * limits.row


def check_together(records: SensorRecords) -> None:
    """InputError when sensors disagree by a factor that only a wrong unit explains, or share no time."""
    _check_times(records)
    for name in ("ephemeris", "chaser_ephemeris"):
        if (orbit := getattr(records, name)) is not None:
            _check_orbit(name, orbit)
    _check_gyro(records)
    _check_ranges(records)


def _check_times(records: SensorRecords) -> None:
    spans = {
        name: (float(data.t.min()), float(data.t.max()))
        for name in ("gyro", "accelerometer", "gnss", "star_tracker", "keypoints", "poses", "chaser_ephemeris")
        if (data := getattr(records, name)) is not None
    }
    low, high = float(records.ephemeris.t.min()), float(records.ephemeris.t.max())
    for name, (first, last) in spans.items():
        if last < low or first > high or last - first > 10.0 * max(high - low, 60.0):
            raise InputError(
                f"{name}.csv covers t = {first:g} to {last:g} s but ephemeris.csv {low:g} to {high:g} s: "
                "times must be seconds since the epoch of records.json"
            )


def _check_orbit(name: str, orbit: EphemerisData) -> None:
    """Velocities are the rates of the positions, and their changes are gravity."""
    order = np.argsort(orbit.t)
    t, r, v = orbit.t[order], orbit.r_eci_m[order], orbit.v_eci_mps[order]
    step = int(np.searchsorted(t, t[0] + _ORBIT_STEP_S))
    dt = t[step:] - t[: len(t) - step]
    near = (dt > 0.5 * _ORBIT_STEP_S) & (dt < 5.0 * _ORBIT_STEP_S)
    if step == 0 or not near.any():
        return
    (r0, r1), (v0, v1), dt = (r[:-step][near], r[step:][near]), (v[:-step][near], v[step:][near]), dt[near, None]
    wrong = np.linalg.norm((r1 - r0) / dt - 0.5 * (v0 + v1), axis=1) / np.linalg.norm(v0, axis=1)
    if np.median(wrong) > _MOST_CHORD_ERROR:
        raise InputError(
            f"{name}.csv: its velocities differ from the rates of its positions by {100 * np.median(wrong):.0f} %: "
            "check that both are in the same axes and units"
        )
    middle = 0.5 * (r0 + r1)
    pull = -MU_EARTH * middle / np.linalg.norm(middle, axis=1, keepdims=True) ** 3
    wrong = np.linalg.norm((v1 - v0) / dt - pull, axis=1) / np.linalg.norm(pull, axis=1)
    if np.median(wrong) > _MOST_PULL_ERROR:
        raise InputError(
            f"{name}.csv: its velocities change otherwise than by Earth's gravity, by {100 * np.median(wrong):.0f} %: "
            "axes that turn with Earth do that; give it in ECI (J2000) axes"
        )


def _check_gyro(records: SensorRecords) -> None:
    """The star tracker's turns tell the gyro's unit."""
    gyro, star = records.gyro, records.star_tracker
    if gyro is None or star is None or len(star.t) < 20 or len(gyro.t) < 20:
        return
    order = np.argsort(star.t)
    t, q = star.t[order], quaternion.normalize(star.q_eci_cam[order])
    step = max(1, len(t) // 50)
    dt = t[step::step] - t[:-step:step][: len(t[step::step])]
    turn = quaternion.log(quaternion.multiply(quaternion.conjugate(q[:-step:step][: len(dt)]), q[step::step]))
    star_rate = turn[dt > 0] / dt[dt > 0, None]
    size = float(np.median(np.linalg.norm(star_rate, axis=1))) if len(star_rate) else 0.0
    seen = float(np.linalg.norm(np.median(gyro.rate, axis=0)))
    if size > _LEAST_TURN and not 0.02 * size < seen < 50.0 * size:
        raise InputError(
            f"gyro.csv turns at {seen:.3g} rad/s but star_tracker.csv at {size:.3g} rad/s: check the unit of the gyro"
        )


def _check_ranges(records: SensorRecords) -> None:
    """GNSS and camera poses measure the same distance."""
    if records.gnss is None or records.poses is None:
        return
    by_gnss = float(np.median(np.linalg.norm(records.gnss.position_m, axis=1)))
    by_camera = float(np.median(np.linalg.norm(records.poses.t_cam_target_m, axis=1)))
    if not 0.05 * by_camera < by_gnss < 20.0 * by_camera:
        raise InputError(
            f"gnss.csv is at {by_gnss:.3g} m in the median but poses.csv at {by_camera:.3g} m: check their units"
        )
