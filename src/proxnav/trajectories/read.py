"""Trajectory files of other tools as one Trajectory: formats are recognised by content, roles by name or order."""

import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError, InputNote
from proxnav.geometry import quaternion
from proxnav.geometry.celestial import EARTH_POLAR_RADIUS, R_eci_lvlh, R_eci_ric
from proxnav.geometry.epochs import Instant
from proxnav.geometry.relative_motion import eci_from_ric
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import Trajectory
from proxnav.trajectories.assemble import assemble
from proxnav.trajectories.elements import fly_elements, parse_elements
from proxnav.trajectories.generators import time_grid
from proxnav.trajectories.orbit import OrbitConfig, fly_orbit
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.readers.history import (
    AttitudeHistory,
    History,
    OrbitHistory,
    sample_attitude,
    sample_orbit,
    span,
)
from proxnav.trajectories.readers.recognise import read_files
from proxnav.trajectories.readers.reference_frames import ORBITAL, check_together

Kind = TypeVar("Kind", OrbitHistory, AttitudeHistory)
Times = Float[np.ndarray, "n"]

_FARTHEST_M = 2e9  # beyond Earth's sphere of influence
_SLOWEST_MPS = 1e-3
_SAME_AXES = (1.0, 0.0, 0.0, 0.0)
"""The model's axes are the body axes whose attitude the file gives."""


def read_trajectory(
    paths: Sequence[str | Path], config: ReaderConfig | None = None, t: Times | None = None
) -> Trajectory:
    """The flight that the files describe, at `t` seconds past the target file's epoch or at the file's own instants.

    The first orbit is the target's and the second the chaser's, unless names say otherwise; the same for attitudes.
    Without attitudes the target is LVLH-fixed and the camera points at it; without a second orbit the chaser holds.
    """
    config = config or ReaderConfig()
    found = read_files(paths, config)
    orbits = [history for history in found if isinstance(history, OrbitHistory)]
    if not orbits:
        raise InputError(f"{_names(paths)}: attitudes but no positions; give the file with the target's orbit as well")
    attitudes = [history for history in found if isinstance(history, AttitudeHistory)]
    hill = [history for history in orbits if history.frame.kind == "ric"]
    named = [history for history in hill if config.chaser in (history.name, Path(history.source).stem)]
    target, chaser = _roles(
        [history for history in orbits if history not in hill], config.target, "" if named else config.chaser
    )
    relative = _only(named or hill, chaser)
    attitude_target, attitude_chaser = _attitude_roles(attitudes, target, chaser, config)
    attitude_chaser = attitude_chaser if config.q_chaser_cam is not None else None
    used = [h for h in (target, relative or chaser, attitude_target, attitude_chaser) if h is not None]
    epoch = used[0].epoch
    t = _instants(used, epoch, config) if t is None else np.asarray(t, dtype=np.float64)
    if target is not None and chaser is not None and relative is None:
        check_together([(h.source, h.frame) for h in (target, chaser)], epoch, t)
    state_target = sample_orbit(target, epoch, t) if target else _assumed_orbit(config, t)
    _check_orbit(*state_target, used[0].source)
    state_chaser = _chaser_states(relative or chaser, state_target, epoch, t, config)
    _tell_notes([history for history in used if history is not relative])
    if relative is not None:
        _tell_relative(relative, target, config, state_chaser[0] - state_target[0])
    return assemble(
        epoch.iso(9),
        t,
        state_target,
        state_chaser,
        q_eci_target=_attitude(attitude_target, epoch, t, state_target, _SAME_AXES),
        q_eci_cam=_attitude(attitude_chaser, epoch, t, state_chaser, config.q_chaser_cam),
        source=_names(paths),
    )


def _roles(
    orbits: list[OrbitHistory], target_name: str, chaser_name: str
) -> tuple[OrbitHistory | None, OrbitHistory | None]:
    """(target, chaser)."""
    target, chaser = _named(orbits, target_name), _named(orbits, chaser_name)
    rest = [history for history in orbits if history is not target and history is not chaser]
    # Basilisk's two-craft tables put the servicer first.
    if target is None and chaser is None and [h.name for h in rest[:2]] == ["1", "2"]:
        rest = [rest[1], rest[0], *rest[2:]]
    if len(rest) + (target is not None) + (chaser is not None) > 2:
        names = ", ".join(history.name for history in orbits)
        raise InputError(
            f"{_names([h.source for h in orbits])}: objects {names}; name two by --reader.target and --reader.chaser"
        )
    if target is None and rest:
        target = rest.pop(0)
    if chaser is None and rest:
        chaser = rest.pop(0)
    return target, chaser


def _only(relative: list[OrbitHistory], chaser: OrbitHistory | None) -> OrbitHistory | None:
    """The chaser's positions relative to the target; InputError where several files or objects give its positions."""
    if len(relative) + (chaser is not None and bool(relative)) > 1:
        said = ", ".join(f"{h.name} of {h.source}" for h in [*relative, *([chaser] if chaser else [])])
        raise InputError(f"the chaser's positions are given more than once, by {said}; name one by --reader.chaser")
    return relative[0] if relative else None


def _attitude_roles(
    attitudes: list[AttitudeHistory],
    target: OrbitHistory | None,
    chaser: OrbitHistory | None,
    config: ReaderConfig,
) -> tuple[AttitudeHistory | None, AttitudeHistory | None]:
    """(target's, chaser's): by the names of roles or orbits, the rest in order."""
    names = (config.target or (target.name if target else ""), config.chaser or (chaser.name if chaser else ""))
    known = {history.name for history in attitudes}
    of_target = _named(attitudes, names[0]) if names[0] in known else None
    of_chaser = _named(attitudes, names[1]) if names[1] in known else None
    rest = [history for history in attitudes if history is not of_target and history is not of_chaser]
    if of_target is None and rest:
        of_target = rest.pop(0)
    if of_chaser is None and rest:
        of_chaser = rest.pop(0)
    return of_target, of_chaser


def _named(options: list[Kind], name: str) -> Kind | None:
    if not name:
        return None
    for history in options:
        if name in (history.name, Path(history.source).stem):
            return history
    names = ", ".join(history.name for history in options)
    raise InputError(f"no object '{name}' in the files, only {names}; correct --reader.target or --reader.chaser")


def _instants(used: list[History], epoch: Instant, config: ReaderConfig) -> Times:
    spans = [span(history, epoch) for history in used]
    first, last = max(start for start, _ in spans), min(stop for _, stop in spans)
    first = first if config.start_s is None else config.start_s
    last = last if config.stop_s is None else config.stop_s
    if first > last:
        sources = _names([history.source for history in used])
        raise InputError(
            f"{sources}: the files share no time, or --reader.start-s is after --reader.stop-s; check their epochs"
        )
    if config.step_s is not None:
        return first + time_grid(last - first, config.step_s)
    own = np.unique(np.concatenate([segment.t for segment in used[0].segments])) + (used[0].epoch - epoch)
    inside = own[(own >= first - 1e-6) & (own <= last + 1e-6)]
    if inside.size == 0:
        raise InputError(
            f"{used[0].source}: no instant between {first:g} s and {last:g} s; resample with --reader.step-s"
        )
    return inside


def _chaser_states(
    history: OrbitHistory | None,
    target: tuple[Vector3, Vector3],
    epoch: Instant,
    t: Times,
    config: ReaderConfig,
) -> tuple[Vector3, Vector3]:
    if history is None:
        rho = np.tile(np.array(config.chaser_ric_m), (len(t), 1))
        return eci_from_ric(*target, rho, np.zeros_like(rho))
    states = sample_orbit(history, epoch, t)
    return eci_from_ric(*target, *states) if history.frame.kind == "ric" else states


def _attitude(
    history: AttitudeHistory | None,
    epoch: Instant,
    t: Times,
    state: tuple[Vector3, Vector3],
    q_body_model: tuple[float, ...] | None,
) -> QuatWxyz | None:
    """q_eci_model; attitudes in orbital axes are completed by the craft's own orbit."""
    if history is None or q_body_model is None:
        return None
    q = quaternion.multiply(sample_attitude(history, epoch, t), quaternion.normalize(np.array(q_body_model)))
    if history.frame.kind not in ORBITAL:
        return q
    axes = R_eci_ric(*state) if history.frame.kind == "ric" else R_eci_lvlh(*state)
    return quaternion.multiply(quaternion.from_matrix(axes), q)


def _check_orbit(r_eci_m: Float[np.ndarray, "n 3"], v_eci_mps: Float[np.ndarray, "n 3"], source: str) -> None:
    """Refuses what no unit or frame makes an orbit about Earth."""
    radius = np.linalg.norm(r_eci_m, axis=1)
    least, most = float(radius.min()), float(radius.max())
    if not (least > 0.98 * EARTH_POLAR_RADIUS and most < _FARTHEST_M):
        where = "inside Earth" if least < EARTH_POLAR_RADIUS else "beyond any orbit about Earth"
        raise InputError(
            f"{source}: the orbit runs from {least / 1e3:.6g} km to {most / 1e3:.6g} km from Earth's centre, {where}: "
            "check the unit of length (DistanceUnit, column headers or --reader.position-unit) and the frame"
        )
    areal = np.linalg.norm(np.cross(r_eci_m, v_eci_mps), axis=1) / radius
    if not (np.isfinite(areal).all() and areal.min() > _SLOWEST_MPS):
        raise InputError(f"{source}: the target does not move around Earth; check the velocities and the frame")


def _assumed_orbit(config: ReaderConfig, t: Times) -> tuple[Vector3, Vector3]:
    """(r, v) of the target whose orbit no file gives."""
    if not config.target_elements:
        return fly_orbit(config.target_orbit, t)
    if config.target_orbit != OrbitConfig():
        raise InputError("--reader.target-elements and --reader.target-orbit both give the target's orbit; give one")
    return fly_elements(parse_elements(config.target_elements), t)


def _tell_notes(used: Sequence[History]) -> None:
    for history in used:
        if history.note:
            what = "attitude" if isinstance(history, AttitudeHistory) else "orbit"
            warnings.warn(f"{history.source}: {what} of {history.name}: {history.note}", InputNote, stacklevel=3)


def _tell_relative(
    history: OrbitHistory, target: OrbitHistory | None, config: ReaderConfig, separation_m: Vector3
) -> None:
    """How far relative positions lead, and about which orbit."""
    distance = np.linalg.norm(separation_m, axis=1)
    circle = f"a circle at {config.target_orbit.altitude_m / 1e3:g} km, {config.target_orbit.inclination_deg:g} deg"
    orbit = f"that of {target.source}" if target else config.target_elements or circle
    given = "" if target else " (--reader.target-orbit or --reader.target-elements say another)"
    warnings.warn(
        f"{history.source}: {history.note}: {distance.min():.4g} to {distance.max():.4g} m from the target, whose "
        f"orbit is {orbit}{given}",
        InputNote,
        stacklevel=3,
    )


def _names(paths: Sequence[str | Path]) -> str:
    return ", ".join(dict.fromkeys(str(path) for path in paths))
