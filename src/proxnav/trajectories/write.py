"""Trajectories as files for other tools: STK, CCSDS and csv, in ICRF, units and order always declared."""

from collections.abc import Sequence
from datetime import datetime
from typing import Literal

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.epochs import Instant, parse_iso
from proxnav.records import Trajectory

Craft = Literal["target", "chaser"]


def stk_ephemeris(trajectory: Trajectory, craft: Craft) -> str:
    """Content of an `.e` file: metres, ICRF, positions and velocities."""
    r, v = _states(trajectory, craft)
    rows = [_row(t, (*a, *b)) for t, a, b in zip(trajectory.t, r, v, strict=True)]
    head = _stk_head("Ephemeris", trajectory, "CoordinateSystem ICRF")
    method = ["InterpolationMethod Hermite", "InterpolationSamplesM1 3", "DistanceUnit Meters"]
    return "\n".join([*head, *method, "", "EphemerisTimePosVel", "", *rows, "", "END Ephemeris", ""])


def stk_attitude(trajectory: Trajectory, craft: Craft) -> str:
    """Content of an `.a` file: quaternions of the target's body or of the camera's axes, scalar last."""
    rows = [_row(t, (*q[1:], q[0])) for t, q in zip(trajectory.t, _attitudes(trajectory, craft), strict=True)]
    head = _stk_head("Attitude", trajectory, "CoordinateAxes ICRF")
    return "\n".join([*head, "InterpolationOrder 1", "", "AttitudeTimeQuaternions", "", *rows, "", "END Attitude", ""])


def oem(trajectory: Trajectory, craft: Craft) -> str:
    """Content of a CCSDS OEM 2.0 in KVN: kilometres."""
    r, v = _states(trajectory, craft)
    stamps = _stamps(trajectory)
    rows = [f"{stamp} {_numbers((*a, *b))}" for stamp, a, b in zip(stamps, r / 1e3, v / 1e3, strict=True)]
    meta = ["REF_FRAME = ICRF", *_ccsds_times(stamps), "INTERPOLATION = HERMITE", "INTERPOLATION_DEGREE = 7"]
    return "\n".join([*_ccsds_head("OEM", "2.0", trajectory, craft), *meta, "META_STOP", "", *rows, ""])


def aem(trajectory: Trajectory, craft: Craft) -> str:
    """Content of a CCSDS AEM 1.0 in KVN: quaternions from ICRF to the body, scalar last."""
    stamps, q = _stamps(trajectory), _attitudes(trajectory, craft)
    rows = [f"{stamp} {_numbers((*x[1:], x[0]))}" for stamp, x in zip(stamps, q, strict=True)]
    frames = ["REF_FRAME_A = ICRF", "REF_FRAME_B = SC_BODY_1", "ATTITUDE_DIR = A2B"]
    kind = ["ATTITUDE_TYPE = QUATERNION", "QUATERNION_TYPE = LAST"]
    head = [*_ccsds_head("AEM", "1.0", trajectory, craft), *frames, *_ccsds_times(stamps), *kind, "META_STOP"]
    return "\n".join([*head, "", "DATA_START", *rows, "DATA_STOP", ""])


def csv(trajectory: Trajectory, orbits: Sequence[Craft], attitudes: Sequence[Craft]) -> str:
    """Content of a csv whose headers say object, frame and unit.

    UTC, then position [m] and velocity [m/s] of each orbit, then the attitudes' quaternions (body to ECI).
    """
    epoch = parse_iso(trajectory.epoch_utc)
    header, blocks = ["Time (UTC)"], [np.empty((len(trajectory), 0))]
    for craft in orbits:
        header += [f"ECI {axis}_{craft} (m)" for axis in "XYZ"] + [f"ECI V{axis}_{craft} (m/s)" for axis in "xyz"]
        blocks += _states(trajectory, craft)
    for craft in attitudes:
        header += [f"q{axis}_{craft}" for axis in "wxyz"]
        blocks.append(_attitudes(trajectory, craft))
    numbers = np.concatenate(blocks, axis=1)
    stamps = [epoch.plus(float(t)).iso(9) for t in trajectory.t]
    rows = [",".join([stamp, *map(repr, row)]) for stamp, row in zip(stamps, numbers.tolist(), strict=True)]
    return "\n".join([",".join(header), *rows, ""])


def _states(trajectory: Trajectory, craft: Craft) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"]]:
    if craft == "target":
        return trajectory.r_eci_target_m, trajectory.v_eci_target_mps
    return trajectory.r_eci_chaser_m, trajectory.v_eci_chaser_mps


def _attitudes(trajectory: Trajectory, craft: Craft) -> Float[np.ndarray, "n wxyz=4"]:
    return quaternion.normalize(trajectory.q_eci_target if craft == "target" else trajectory.q_eci_cam)


def _stk_head(kind: str, trajectory: Trajectory, frame: str) -> list[str]:
    points = f"NumberOf{kind}Points {len(trajectory)}"
    epoch = f"ScenarioEpoch {_gregorian(parse_iso(trajectory.epoch_utc))}"
    return ["stk.v.11.0", "", f"BEGIN {kind}", points, epoch, "CentralBody Earth", frame]


def _ccsds_head(kind: str, version: str, trajectory: Trajectory, craft: Craft) -> list[str]:
    # The creation date is the epoch: a writer without a clock gives the same file every time.
    head = [f"CCSDS_{kind}_VERS = {version}", f"CREATION_DATE = {parse_iso(trajectory.epoch_utc).iso().rstrip('Z')}"]
    return [*head, "ORIGINATOR = PROXNAV", "", "META_START", f"OBJECT_NAME = {craft.upper()}", "OBJECT_ID = UNKNOWN",
            "CENTER_NAME = EARTH"]  # fmt: skip


def _ccsds_times(stamps: list[str]) -> list[str]:
    return ["TIME_SYSTEM = UTC", f"START_TIME = {stamps[0]}", f"STOP_TIME = {stamps[-1]}"]


def _stamps(trajectory: Trajectory) -> list[str]:
    epoch = parse_iso(trajectory.epoch_utc)
    return [epoch.plus(float(t)).iso(9).rstrip("Z") for t in trajectory.t]


def _gregorian(epoch: Instant) -> str:
    date, clock = epoch.iso(9).rstrip("Z").split("T")
    day = datetime.fromisoformat(date)
    month = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")[day.month - 1]
    return f"{day.day} {month} {day.year} {clock if '.' in clock else clock + '.0'}"


def _row(t: float, values: tuple[float, ...]) -> str:
    return f"{t:.9f} {_numbers(values)}"


def _numbers(values: tuple[float, ...]) -> str:
    return " ".join(f"{value:.16e}" for value in values)
