"""The filter in real time: readings in the order of arrival, each applied at the time when it was taken.

A ring of beliefs leads back: a late reading is put in its place and everything after it is replayed.
"""

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.navigation.apply import apply
from proxnav.navigation.belief import Belief, Waiting, nav_state
from proxnav.navigation.filter_setup import Ephemeris, FilterSetup
from proxnav.navigation.grown_ephemeris import check_reaches, grown, reaches
from proxnav.navigation.measurements import Outcome, Verdict
from proxnav.navigation.monitor.monitor import Finding, Monitor
from proxnav.navigation.monitor.orbit_trial import OtherOrbit
from proxnav.navigation.monitor.refusals import Refusals
from proxnav.navigation.mounting import in_camera_axes
from proxnav.navigation.propagate import predicted
from proxnav.navigation.readings import ORDER, KeypointFrame, Reading, rank
from proxnav.navigation.saved import SavedNavigator, read_navigator, setup_of_saved, write_navigator
from proxnav.navigation.stream import monitored
from proxnav.records import NavState, NavStatus, SensorRecords

BUFFER_S = 15.0
"""Measurements that arrive later than this are counted and left out: far more than any camera or receiver takes."""
_AHEAD_S = 1.0


class Judged(NamedTuple):
    """A reading and what became of it."""

    reading: Reading
    verdict: Verdict


class Answer(NamedTuple):
    """What a reading leads to."""

    state: NavState | None
    """The state after everything received so far; None before the first pose."""
    verdict: Verdict
    """What became of the reading."""


@dataclass(slots=True)
class _Entry:
    reading: Reading
    belief: Belief
    verdict: Verdict


def _forget(_: Judged) -> None:
    """What becomes of readings that can no longer change, unless somebody asks."""


class Navigator:
    """The filter on line: takes readings one by one, in the order of arrival; `belief` is the newest.

    `t0` [s] is not later than any reading. `settled` gets each reading with its verdict once that can no longer change,
    in the order of time. `other` lets the monitor compare the target's ephemeris with the chaser's own.
    """

    def __init__(
        self, setup: FilterSetup, t0: float, settled: Callable[[Judged], None] = _forget,
        other: OtherOrbit | None = None,
    ) -> None:  # fmt: skip
        self._setup = setup
        self._origin: Belief = Waiting(t0)
        self._ring: list[_Entry] = []
        self._keys: list[tuple[float, int]] = []
        self._newest = t0
        self._stale = 0
        """First place of the ring whose belief is not up to date."""
        self._settled = settled
        self._monitor = Monitor(setup, other)
        self._refusals = Refusals()

    @property
    def belief(self) -> Belief:
        """The belief after everything received so far."""
        self._replay()
        return self._ring[-1].belief if self._ring else self._origin

    @property
    def findings(self) -> tuple[Finding, ...]:
        """Contradictions between sensors that the monitor has found, the first first."""
        return (*self._monitor.learnt.findings, *self._refusals.findings)

    @property
    def compared(self) -> tuple[str, ...]:
        """Pairs of sensors that the monitor could compare so far: what is not here is not checked."""
        return self._monitor.learnt.compared

    @property
    def status(self) -> NavStatus:
        """What the belief is worth, also before the first pose."""
        return "suspect" if self.findings else self.belief.status

    def at(self, t: float) -> NavState | None:
        """State and covariance at `t` [s], predicted from the last belief before it; None before the first pose.

        Back to the oldest belief that is kept, 15 s or more; before that the oldest is given.
        """
        self._replay()
        place = bisect_right(self._keys, (t, len(ORDER)))
        belief = self._ring[place - 1].belief if place else self._origin
        if isinstance(belief, Waiting):
            return None
        check_reaches(self._setup.ephemeris, t)
        state = nav_state(predicted(belief, t, self._setup), self._setup)
        causes = "; ".join(finding.cause for finding in self.findings)
        return replace(state, status="suspect", cause=causes) if causes else state

    def receive(self, reading: Reading) -> Answer:
        """Applies a reading at its own time, replays what came after, and gives the newest state with the verdict."""
        entry = self.put(reading)
        self._replay()
        return Answer(self.at(self._newest), entry if isinstance(entry, Verdict) else entry.verdict)

    def put(self, reading: Reading) -> "_Entry | Verdict":
        """Takes a reading without looking at it yet: it is applied, in its place, when the belief is next asked for."""
        reading = in_camera_axes(reading, self._setup.config.mounting)
        self._monitor.take(reading)
        if isinstance(reading, KeypointFrame) and self._setup.config.coupling == "loose":
            return Verdict("unused")
        refused = self._refusal(reading)
        if refused is not None:
            self._settle(Judged(reading, Verdict(refused)))
            return Verdict(refused)
        key = rank(reading)
        place = bisect_right(self._keys, key)
        entry = _Entry(reading, self._origin, Verdict("accepted"))
        self._keys.insert(place, key)
        self._ring.insert(place, entry)
        self._stale = min(self._stale, place)
        self._newest = max(self._newest, reading.t)
        self._drop_old()
        return entry

    def extend(self, rows: Ephemeris) -> None:
        """More of the target's ephemeris: rows after the last one. Give them before the readings that they cover."""
        self._setup = replace(self._setup, ephemeris=grown(self._setup.ephemeris, rows))
        self._monitor.setup = self._setup

    def extend_chaser(self, rows: Ephemeris) -> None:
        """More of the chaser's own ephemeris, where there is one."""
        other = self._monitor.other
        if other is not None:
            self._monitor.other = other._replace(chaser=grown(other.chaser, rows))

    def finish(self) -> None:
        """Judges what is still in the ring."""
        self._replay()
        for entry in self._ring:
            self._settle(Judged(entry.reading, entry.verdict))

    def save(self, path: Path) -> None:
        """All that goes on, as one JSON file: `Navigator.load` goes on with the same bytes."""
        ring = tuple(entry.reading for entry in self._ring)
        parts = (self._setup, self._origin, ring, self._newest, self._monitor, self._refusals)
        write_navigator(path, SavedNavigator.of(*parts))

    @classmethod
    def load(cls, path: Path, settled: Callable[[Judged], None] = _forget) -> "Navigator":
        """The navigator that `save` wrote. InputError where the file is none."""
        saved = read_navigator(path)
        navigator = cls(setup_of_saved(saved), saved.newest, settled)
        navigator._origin, navigator._newest = saved.origin, saved.newest
        navigator._ring = [_Entry(reading, saved.origin, Verdict("accepted")) for reading in saved.ring]
        navigator._keys = [rank(reading) for reading in saved.ring]
        navigator._monitor, navigator._refusals = saved.monitor(navigator._setup), saved.refusals
        return navigator

    def _refusal(self, reading: Reading) -> Outcome | None:
        if reading.t > max(reading.received, self._newest) + _AHEAD_S:
            return "ahead"
        if not reaches(self._setup.ephemeris, reading.t):
            return "invalid"
        if reading.t < max(self._newest - BUFFER_S, self._origin.t):
            return "late"
        place = bisect_right(self._keys, rank(reading))
        if place and self._keys[place - 1] == rank(reading):
            return "duplicate"
        return None

    def _replay(self) -> None:
        """Applies again what a newly placed reading has made stale."""
        first, self._stale = self._stale, len(self._ring)
        if first >= len(self._ring):
            return
        belief = self._ring[first - 1].belief if first else self._origin
        for entry in self._ring[first:]:
            belief, entry.verdict = apply(belief, entry.reading, self._setup)
            entry.belief = belief

    def _drop_old(self) -> None:
        """Drops entries that no late reading may reach any more; the oldest kept belief is the new origin."""
        count = bisect_right(self._keys, (self._newest - BUFFER_S, -1))
        if count < 32:
            return
        self._replay()
        for entry in self._ring[:count]:
            self._settle(Judged(entry.reading, entry.verdict))
        self._origin = self._ring[count - 1].belief
        del self._ring[:count], self._keys[:count]
        self._stale = len(self._ring)
        if not self._monitor.learnt.findings:
            self._refusals = self._refusals.judged(self._newest, self._origin.memory)

    def _settle(self, judged: Judged) -> None:
        self._refusals = self._refusals.also(judged.reading, judged.verdict)
        self._settled(judged)


class Navigated(NamedTuple):
    """What the filter said along a flight."""

    states: list[NavState | None]
    """As they stood in real time at the asked instants."""
    judged: list[Judged]
    """Every reading with its verdict."""
    belief: Belief
    """The last one."""
    findings: tuple[Finding, ...]
    compared: tuple[str, ...]
    """Pairs of sensors that the monitor could compare."""


def navigated(
    records: SensorRecords, setup: FilterSetup, times: Float[np.ndarray, "n"], done: Callable[[], None] = lambda: None
) -> Navigated:
    """Filters a flight's records as they would have arrived. `done` is called after each of `times`."""
    stream = monitored(records, setup)
    judged: list[Judged] = []
    first = min((reading.t for reading in stream), default=0.0)
    navigator = Navigator(setup, first, judged.append, other_orbit(records))
    found, k = [], 0
    for t in times.tolist():
        while k < len(stream) and stream[k].received <= t + 1e-9:
            navigator.put(stream[k])
            k += 1
        found.append(navigator.at(t))
        done()
    navigator.finish()
    return Navigated(found, judged, navigator.belief, navigator.findings, navigator.compared)


def run_filter(
    records: SensorRecords, setup: FilterSetup, times: Float[np.ndarray, "n"], done: Callable[[], None] = lambda: None
) -> tuple[list[NavState | None], list[Judged], Belief]:
    """States as they stood in real time at `times`, every reading with its verdict, and the last belief."""
    return navigated(records, setup, times, done)[:3]


def other_orbit(records: SensorRecords) -> OtherOrbit | None:
    """The chaser's own ephemeris in the order of time, where the records have one."""
    chaser = records.chaser_ephemeris
    if chaser is None:
        return None
    order = np.argsort(chaser.t)
    columns = (np.ascontiguousarray(c[order]) for c in (chaser.t, chaser.r_eci_m, chaser.v_eci_mps))
    return OtherOrbit(records.epoch_utc, Ephemeris(*columns))
