"""The filter in real time: readings in the order of arrival, each applied at the time when it was taken.

A ring of beliefs leads back: a late reading is put in its place and everything after it is replayed.
"""

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from proxnav.datasets.sensor_records.plausibility import check_together
from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.navigation.belief import Belief, Scene, nav_state
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.events import Event, apply, events
from proxnav.navigation.observe import Outcome, Verdict
from proxnav.navigation.propagate import propagate
from proxnav.records import NavState, SensorRecords

R_RIC_LVLH = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""LVLH: x along the flight, y against the orbit's normal, z to nadir."""
_LONGEST_EPHEMERIS_STEP_S = 120.0
_AHEAD_S = 1.0


class Judged(NamedTuple):
    """A reading and what became of it."""

    event: Event
    verdict: Verdict


@dataclass(slots=True)
class _Entry:
    event: Event
    belief: Belief
    verdict: Verdict


def make_scene(
    ephemeris: tuple[np.ndarray, np.ndarray, np.ndarray],
    points_m: np.ndarray,
    camera: Camera,
    config: NavigationConfig,
    has_gyro: bool,
) -> Scene:
    """What a run needs besides its readings. InputError where the ephemeris is too coarse."""
    t, r, v = (np.ascontiguousarray(column, dtype=np.float64) for column in ephemeris)
    order = np.argsort(t, kind="stable")
    t, r, v = t[order], r[order], v[order]
    if len(t) < 2 or not np.diff(t).min() > 0.0 or np.diff(t).max() > _LONGEST_EPHEMERIS_STEP_S:
        gap = f"{np.diff(t).max():g} s" if len(t) > 1 else f"{len(t)} row"
        raise InputError(
            f"the ephemeris needs distinct times at most {_LONGEST_EPHEMERIS_STEP_S:g} s apart, found {gap}: "
            "give it in smaller steps"
        )
    gyro = has_gyro and config.gyro
    points = np.ascontiguousarray(points_m, dtype=np.float64)
    inertia = config.inertia if config.inertia and config.target == "free" else (0.0, 0.0, 0.0)
    return Scene(
        config=config, camera=camera.undistorted(), real_camera=camera, points_m=points, ephemeris=(t, r, v),
        own_antenna=np.array(config.chaser_antenna_cam_m), other_antenna=np.array(config.target_antenna_target_m),
        has_gyro=gyro, R_ric_held=R_RIC_LVLH @ quaternion.to_matrix(np.array(config.held.q_lvlh_target)),
        inertia=np.array(inertia),
        shares=np.array([config.noise.camera.point_share, config.noise.camera.white_share]),
        noise=config.noise_vector(gyro),
        frame_gates=config.gates.frame_gates(2 * len(points)),
    )  # fmt: skip


def scene_of(records: SensorRecords, points_m: np.ndarray, camera: Camera, config: NavigationConfig) -> Scene:
    """The scene of a run's records, which are checked against each other first."""
    check_together(records)
    if records.star_tracker is None:
        raise InputError("no star tracker records: the filter needs them to know how the camera is turned")
    if records.keypoints is not None and records.keypoints.pixels.shape[1] > len(points_m):
        raise InputError(
            f"the keypoints number {records.keypoints.pixels.shape[1]} but the target has {len(points_m)}: "
            "give the target whose points the detector finds"
        )
    e = records.ephemeris
    return make_scene((e.t, e.r_eci_m, e.v_eci_mps), points_m, camera, config, records.gyro is not None)


class Navigator:
    """Takes readings one by one, in the order of arrival; `belief` is the newest."""

    def __init__(self, scene: Scene, t0: float) -> None:
        self._scene = scene
        self._origin = Belief(t0)
        self._ring: list[_Entry] = []
        self._keys: list[tuple[float, int]] = []
        self._newest = t0
        self._stale = 0
        """First place of the ring whose belief is not up to date."""
        self.judged: list[Judged] = []
        """Readings that can no longer change, in the order of their time."""

    @property
    def belief(self) -> Belief:
        """After everything received so far."""
        self._replay()
        return self._ring[-1].belief if self._ring else self._origin

    def at(self, t: float) -> NavState | None:
        """The belief predicted to `t`; None before the first pose."""
        belief = self.belief
        return nav_state(propagate(belief, t, self._scene) if belief.t < t else belief, self._scene)

    def receive(self, event: Event) -> Outcome:
        """Applies a reading at its own time; replays what came after."""
        entry = self.put(event)
        if isinstance(entry, Verdict):
            return entry.outcome
        self._replay()
        return entry.verdict.outcome

    def put(self, event: Event) -> "_Entry | Verdict":
        """Takes a reading without looking at it yet: it is applied, in its place, when the belief is next asked for."""
        refused = self._refusal(event)
        if refused is not None:
            self.judged.append(Judged(event, Verdict(refused)))
            return Verdict(refused)
        place = bisect_right(self._keys, event.rank)
        entry = _Entry(event, self._origin, Verdict("accepted"))
        self._keys.insert(place, event.rank)
        self._ring.insert(place, entry)
        self._stale = min(self._stale, place)
        self._newest = max(self._newest, event.t)
        self._forget()
        return entry

    def finish(self) -> None:
        """Judges what is still in the ring."""
        self._replay()
        self.judged.extend(Judged(entry.event, entry.verdict) for entry in self._ring)

    def _refusal(self, event: Event) -> Outcome | None:
        if event.t > max(event.received, self._newest) + _AHEAD_S:
            return "ahead"
        if event.t < max(self._newest - self._scene.config.buffer_s, self._origin.t):
            return "late"
        place = bisect_right(self._keys, event.rank)
        if place and self._keys[place - 1] == event.rank:
            return "duplicate"
        return None

    def _replay(self) -> None:
        """Applies again what a newly placed reading has made stale."""
        first, self._stale = self._stale, len(self._ring)
        if first >= len(self._ring):
            return
        belief = self._ring[first - 1].belief if first else self._origin
        for entry in self._ring[first:]:
            belief, entry.verdict = apply(belief, entry.event, self._scene)
            entry.belief = belief

    def _forget(self) -> None:
        """Drops entries that no late reading may reach any more; the oldest kept belief is the new origin."""
        horizon = self._newest - self._scene.config.buffer_s
        count = bisect_right(self._keys, (horizon, -1))
        if count < 32:
            return
        self._replay()
        for entry in self._ring[:count]:
            self.judged.append(Judged(entry.event, entry.verdict))
        self._origin = self._ring[count - 1].belief
        del self._ring[:count], self._keys[:count]
        self._stale = len(self._ring)


def run_filter(
    records: SensorRecords, scene: Scene, times: np.ndarray, done: Callable[[], None] = lambda: None
) -> tuple[list[NavState | None], list[Judged], Belief]:
    """States as they stood in real time at `times`, every reading with its verdict, and the last belief.

    `done` is called after each of `times`.
    """
    stream = events(records, scene)
    t0 = min((event.t for event in stream), default=0.0)
    navigator = Navigator(scene, t0)
    found, k = [], 0
    for t in times.tolist():
        while k < len(stream) and stream[k].received <= t + 1e-9:
            navigator.put(stream[k])
            k += 1
        found.append(navigator.at(t))
        done()
    navigator.finish()
    return found, navigator.judged, navigator.belief
