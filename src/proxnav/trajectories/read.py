"""Trajectory files of other tools as one Trajectory: formats are recognised by content, roles by name or order."""

import warnings
from collections.abc import Sequence
from pathlib import Path

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
from proxnav.trajectories.roles import assigned

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
    roles = assigned(read_files(paths, config), config)
    used, target = roles.used, roles.target
    epoch = used[0].epoch
    t = _instants(used, epoch, config) if t is None else np.asarray(t, dtype=np.float64)
    if target is not None and roles.chaser is not None and not roles.is_relative:
        check_together([(h.source, h.frame) for h in (target, roles.chaser)], epoch, t)
    state_target = sample_orbit(target, epoch, t) if target else _assumed_orbit(config, t)
    _check_orbit(*state_target, used[0].source)
    state_chaser = _chaser_states(roles.chaser, state_target, epoch, t, config)
    _tell_notes([history for history in used if history is not roles.chaser or not roles.is_relative])
    if roles.chaser is not None and roles.is_relative:
        _tell_relative(roles.chaser, target, config, state_chaser[0] - state_target[0])
    return assemble(
        epoch.iso(9),
        t,
        state_target,
        state_chaser,
        q_eci_target=_attitude(roles.attitude_target, epoch, t, state_target, _SAME_AXES),
        q_eci_cam=_attitude(roles.attitude_chaser, epoch, t, state_chaser, config.q_chaser_cam),
        source=_names(paths),
    )


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
