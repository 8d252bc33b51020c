"""Orbit and attitude histories as files give them, and their values in between by the declared interpolation."""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.epochs import Instant
from proxnav.geometry.pointing import continuous
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.trajectories.readers.polynomials import polynomials
from proxnav.trajectories.readers.reference_frames import ORBITAL, ReferenceFrame, q_eci_frame, state_to_eci

Method = Literal["lagrange", "hermite"]
Series = Float[np.ndarray, "n"]

_SLACK_S = 1e-6  # rounding of printed times


@dataclass(frozen=True, slots=True, eq=False)
class Segment:
    """An arc without manoeuvres; nothing is interpolated from one segment into another."""

    t: Series
    """Seconds past the history's epoch, strictly increasing."""
    values: Float[np.ndarray, "n k"]
    """Positions [m] or quaternions q_frame_body, wxyz."""
    rates: Float[np.ndarray, "n 3"] | None = None
    """Velocities [m/s]."""


@dataclass(frozen=True, slots=True, eq=False)
class OrbitHistory:
    """Positions of one object's centre."""

    name: str
    source: str
    epoch: Instant
    frame: ReferenceFrame
    segments: tuple[Segment, ...]
    method: Method = "lagrange"
    nodes: int = 6
    """Points per interpolating polynomial."""
    note: str = ""
    """What its reader did that its giver should know, said when it is used."""


@dataclass(frozen=True, slots=True, eq=False)
class AttitudeHistory:
    """Attitudes of one object's body axes."""

    name: str
    source: str
    epoch: Instant
    frame: ReferenceFrame
    segments: tuple[Segment, ...]
    nodes: int = 2
    """Points per polynomial; 2 is the shorter great arc between neighbours."""
    note: str = ""
    """What is doubtful about it, said when it is used."""


History = OrbitHistory | AttitudeHistory


def span(history: History, epoch: Instant) -> tuple[float, float]:
    """First and last time [s] past `epoch`."""
    shift = history.epoch - epoch
    return float(history.segments[0].t[0]) + shift, float(history.segments[-1].t[-1]) + shift


def sample_orbit(history: OrbitHistory, epoch: Instant, t: Series) -> tuple[Vector3, Vector3]:
    """(r, v) at `t` seconds past `epoch`, in ECI; a history in RIC stays in RIC."""
    r, v = np.empty((len(t), 3)), np.empty((len(t), 3))
    local = t + (epoch - history.epoch)
    for segment, mask in _by_segment(history, local):
        r[mask], v[mask] = _interpolate_states(history, segment, local[mask])
    if history.frame.kind == "ric":
        return r, v
    return state_to_eci(history.frame, epoch, t, r, v)


def sample_attitude(history: AttitudeHistory, epoch: Instant, t: Series) -> QuatWxyz:
    """q_eci_body at `t` seconds past `epoch`, (n, 4); in orbital axes they stay relative to these."""
    q = np.empty((len(t), 4))
    local = t + (epoch - history.epoch)
    for segment, mask in _by_segment(history, local):
        q[mask] = _interpolate_attitudes(segment, local[mask], history.nodes)
    if history.frame.kind in ORBITAL:
        return q
    return quaternion.multiply(q_eci_frame(history.frame, epoch, t), q)


def rate_note(t: Series, q: QuatWxyz, rates: Vector3) -> str:
    """A note where body rates [rad/s] disagree with the quaternions' differences; empty where they agree."""
    dt = np.diff(t)
    moving = dt > 0.0
    turn = quaternion.log(quaternion.multiply(quaternion.conjugate(q[:-1]), q[1:]))[moving] / dt[moving, None]
    given = 0.5 * (rates[:-1] + rates[1:])[moving]
    fast = np.linalg.norm(given, axis=1) * dt[moving] > 1.0  # steps too long to tell a rate from an alias
    if fast.all():
        return ""
    departure = float(np.median(np.linalg.norm(turn - given, axis=1)[~fast]))
    if departure <= 1e-5 + 0.05 * float(np.median(np.linalg.norm(given, axis=1))):
        return ""
    return f"its quaternions turn by {departure:.3g} rad/s other than its rate columns say; trust neither blindly"


def split(t: Series, boundaries: Float[np.ndarray, "n_boundaries"]) -> list[slice]:
    """Rows of each segment: split where two rows share their time and at the boundaries, whose row serves both."""
    pieces, start = [], 0
    for k in range(1, len(t)):
        if t[k] == t[k - 1]:
            pieces.append(slice(start, k))
            start = k
        elif np.abs(boundaries - t[k]).min(initial=np.inf) < _SLACK_S and k + 1 < len(t) and t[k + 1] != t[k]:
            pieces.append(slice(start, k + 1))
            start = k
    return [*pieces, slice(start, len(t))]


def _by_segment(history: History, local: Series) -> list[tuple[Segment, Bool[np.ndarray, "n"]]]:
    """Segments with the queries that fall into them; at a boundary the later segment answers."""
    owner = np.full(len(local), -1)
    for k, segment in enumerate(history.segments):
        owner[(local >= segment.t[0] - _SLACK_S) & (local <= segment.t[-1] + _SLACK_S)] = k
    if (owner < 0).any():
        missing = history.epoch.plus(float(local[owner < 0][0])).iso(3)
        first, last = (
            history.epoch.plus(float(x)).iso(3) for x in (history.segments[0].t[0], history.segments[-1].t[-1])
        )
        raise InputError(
            f"{history.source}: no data for {history.name or 'the object'} at {missing}; it covers {first} to {last}, "
            "gaps excepted: choose times within"
        )
    return [(segment, owner == k) for k, segment in enumerate(history.segments) if (owner == k).any()]


def _interpolate_states(history: OrbitHistory, segment: Segment, t: Series) -> tuple[Vector3, Vector3]:
    if segment.rates is None and len(segment.t) < 2:
        raise InputError(f"{history.source}: a single position without velocity is no orbit; give two points or more")
    if history.method == "hermite" and segment.rates is not None:
        return polynomials(segment.t, segment.values, segment.rates, t, history.nodes)
    r, slope = polynomials(segment.t, segment.values, None, t, history.nodes)
    if segment.rates is None:
        return r, slope
    return r, polynomials(segment.t, segment.rates, None, t, history.nodes)[0]


def _interpolate_attitudes(segment: Segment, t: Series, nodes: int) -> QuatWxyz:
    q = continuous(segment.values)
    if len(segment.t) == 1:
        return np.tile(q, (len(t), 1))
    if nodes > 2:
        return quaternion.normalize(polynomials(segment.t, q, None, t, nodes)[0])
    k = np.clip(np.searchsorted(segment.t, t, side="right") - 1, 0, len(segment.t) - 2)
    return quaternion.slerp(q[k], q[k + 1], (t - segment.t[k]) / (segment.t[k + 1] - segment.t[k]))
