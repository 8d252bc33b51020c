"""The filter in real time: readings in the order of arrival, each applied at the time when it was taken.

A ring of beliefs leads back: a late reading is put in its place and everything after it is replayed.
"""

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.navigation.apply import apply
from proxnav.navigation.belief import Belief, Waiting, nav_state
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.measurements import Outcome, Verdict
from proxnav.navigation.propagate import predicted
from proxnav.navigation.readings import Reading, rank
from proxnav.navigation.stream import readings
from proxnav.records import NavState, SensorRecords

BUFFER_S = 15.0
"""Measurements that arrive later than this are counted and left out: far more than any camera or receiver takes."""
_AHEAD_S = 1.0


class Judged(NamedTuple):
    """A reading and what became of it."""

    reading: Reading
    verdict: Verdict


@dataclass(slots=True)
class _Entry:
    reading: Reading
    belief: Belief
    verdict: Verdict


class Navigator:
    """Takes readings one by one, in the order of arrival; `belief` is the newest."""

    def __init__(self, setup: FilterSetup, t0: float) -> None:
        self._setup = setup
        self._origin: Belief = Waiting(t0)
        self._ring: list[_Entry] = []
        self._keys: list[tuple[float, int]] = []
        self._newest = t0
        self._stale = 0
        """First place of the ring whose belief is not up to date."""
        self.judged: list[Judged] = []
        """Readings that can no longer change, in the order of their time."""

    @property
    def belief(self) -> Belief:
        """The belief after everything received so far."""
        self._replay()
        return self._ring[-1].belief if self._ring else self._origin

    def at(self, t: float) -> NavState | None:
        """The belief predicted to `t`; None before the first pose."""
        belief = self.belief
        return None if isinstance(belief, Waiting) else nav_state(predicted(belief, t, self._setup), self._setup)

    def receive(self, reading: Reading) -> Outcome:
        """Applies a reading at its own time; replays what came after."""
        entry = self.put(reading)
        if isinstance(entry, Verdict):
            return entry.outcome
        self._replay()
        return entry.verdict.outcome

    def put(self, reading: Reading) -> "_Entry | Verdict":
        """Takes a reading without looking at it yet: it is applied, in its place, when the belief is next asked for."""
        refused = self._refusal(reading)
        if refused is not None:
            self.judged.append(Judged(reading, Verdict(refused)))
            return Verdict(refused)
        key = rank(reading)
        place = bisect_right(self._keys, key)
        entry = _Entry(reading, self._origin, Verdict("accepted"))
        self._keys.insert(place, key)
        self._ring.insert(place, entry)
        self._stale = min(self._stale, place)
        self._newest = max(self._newest, reading.t)
        self._forget()
        return entry

    def finish(self) -> None:
        """Judges what is still in the ring."""
        self._replay()
        self.judged.extend(Judged(entry.reading, entry.verdict) for entry in self._ring)

    def _refusal(self, reading: Reading) -> Outcome | None:
        if reading.t > max(reading.received, self._newest) + _AHEAD_S:
            return "ahead"
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

    def _forget(self) -> None:
        """Drops entries that no late reading may reach any more; the oldest kept belief is the new origin."""
        count = bisect_right(self._keys, (self._newest - BUFFER_S, -1))
        if count < 32:
            return
        self._replay()
        for entry in self._ring[:count]:
            self.judged.append(Judged(entry.reading, entry.verdict))
        self._origin = self._ring[count - 1].belief
        del self._ring[:count], self._keys[:count]
        self._stale = len(self._ring)


def run_filter(
    records: SensorRecords, setup: FilterSetup, times: Float[np.ndarray, "n"], done: Callable[[], None] = lambda: None
) -> tuple[list[NavState | None], list[Judged], Belief]:
    """States as they stood in real time at `times`, every reading with its verdict, and the last belief.

    `done` is called after each of `times`.
    """
    stream = readings(records, setup)
    navigator = Navigator(setup, min((reading.t for reading in stream), default=0.0))
    found, k = [], 0
    for t in times.tolist():
        while k < len(stream) and stream[k].received <= t + 1e-9:
            navigator.put(stream[k])
            k += 1
        found.append(navigator.at(t))
        done()
    navigator.finish()
    return found, navigator.judged, navigator.belief
