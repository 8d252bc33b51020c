"""The monitor: raw readings in, findings out. It never touches the filter's state."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.monitor.account import Account
from proxnav.navigation.monitor.attitude_trial import attitude_account
from proxnav.navigation.monitor.baseline_trial import baseline_account, baseline_fit
from proxnav.navigation.monitor.clocks import ClockOffset, camera_clock, gyro_clock
from proxnav.navigation.monitor.conventions import AS_ASKED, MOUNTINGS, READINGS_OF_QUATERNIONS, Convention
from proxnav.navigation.monitor.evidence import CLEARLY, Fit
from proxnav.navigation.monitor.finding import Finding
from proxnav.navigation.monitor.gyro_trial import gyro_account, gyro_fit
from proxnav.navigation.monitor.keypoint_trial import keypoint_account
from proxnav.navigation.monitor.orbit_trial import OtherOrbit, orbit_account
from proxnav.navigation.monitor.scene import READINGS_OF_POSES, PoseConvention, Scene, scene_of
from proxnav.navigation.monitor.window import window_of
from proxnav.navigation.readings import Acceleration, Reading

WINDOW_S = 55.0
EVERY_S, OFTEN_UNTIL_S, LATER_EVERY_S = 10.0, 120.0, 60.0
"""Conventions are wrong from the first reading on: after two minutes a verdict a minute is enough."""
FIRST_AFTER_S = 40.0
"""So long after the first reading the first verdict: less motion tells too little."""
LATE_S = 4.0
"""Readings of the last seconds may still be under way."""
_AGAIN = 3
"""A contradiction that no convention explains is said when it has been met so often in a row."""
_UNNAMED = 2.5
_BURN = 0.02  # m/s^2, where nobody tells of thrusters
Motion = Literal["coasting", "perhaps steered"]
CLOCK_OF_GYRO, CLOCK_OF_CAMERA = "gyro against star tracker", "camera against star tracker"


@dataclass(frozen=True, slots=True)
class Learnt:
    """What the monitor keeps from window to window."""

    findings: tuple[Finding, ...] = ()
    compared: tuple[str, ...] = ()
    """Pairs of sensors that could be compared at least once."""
    gyro_excluded: frozenset[int] = frozenset()
    """Conventions of the gyro that flight has refuted while the plain one held."""
    gnss_excluded: frozenset[int] = frozenset()
    settled: frozenset[str] = frozenset()
    """Kinds of contradiction that a finding explains: no need to search again."""
    doubts: tuple[tuple[str, int], ...] = ()
    """How often in a row each kind of contradiction went without a name."""
    gyro_clock: ClockOffset = field(default_factory=ClockOffset)
    camera_clock: ClockOffset = field(default_factory=ClockOffset)
    clocks_t: float = -np.inf
    """Readings up to then have taught the clocks [s]."""


@dataclass(slots=True)
class Monitor:
    """Takes readings in the order of arrival; `learnt` is what they have shown so far."""

    setup: FilterSetup
    other: OtherOrbit | None = None
    learnt: Learnt = field(default_factory=Learnt)
    recent: list[Reading] = field(default_factory=list)
    next_t: float | None = None
    """When the next verdict is due."""
    first_t: float = 0.0
    force_t: float = -np.inf
    """Last reading of the accelerometer..."""
    burn_t: float = -np.inf
    """... and the last one within a burn [s]."""

    def take(self, reading: Reading) -> None:
        """Keeps a reading for the next verdict, which is given when it is due."""
        if isinstance(reading, Acceleration):
            self.force_t = reading.t
            if reading.thrust > 0.5 or (reading.thrust < 0.0 and float(np.linalg.norm(reading.specific_force)) > _BURN):
                self.burn_t = reading.t
            return
        if self.next_t is None:
            self.first_t, self.next_t = reading.received, reading.received + FIRST_AFTER_S
        if reading.received >= self.next_t + LATE_S:
            self._judge(self.next_t, reading.received)
            every = EVERY_S if self.next_t < self.first_t + OFTEN_UNTIL_S else LATER_EVERY_S
            self.next_t = max(self.next_t + every, reading.received - LATE_S)
            first = self.next_t - WINDOW_S
            self.recent = [r for r in self.recent if first <= r.t <= reading.received + WINDOW_S]
        self.recent.append(reading)

    def _judge(self, last: float, now: float) -> None:
        scene = scene_of(window_of(self.recent, last - WINDOW_S, last), self.setup)
        coasts = self.force_t > last - LATE_S and self.burn_t < last - WINDOW_S
        self.learnt = judged(scene, self.other, self.learnt, (last, now), "coasting" if coasts else "perhaps steered")


@dataclass(frozen=True, slots=True)
class _Story:
    """What all tests say if the files have these conventions."""

    cost: float
    accounts: tuple[Account, ...]


def judged(
    scene: Scene, other: OtherOrbit | None, learnt: Learnt, when: tuple[float, float], motion: Motion
) -> Learnt:  # fmt: skip
    """What is known after one more window; `when`: its end, and the time of its verdict.

    Only a path that no thruster bends is as smooth as the camera's clock needs it.
    """
    last, now = when
    plain = _story(scene, AS_ASKED, READINGS_OF_POSES[0], learnt)
    clocks = (learnt.gyro_clock, learnt.camera_clock)
    if plain.cost == 0.0 and last - WINDOW_S >= learnt.clocks_t:  # windows that share no reading, conventions that hold
        camera = camera_clock(scene, clocks[1]) if motion == "coasting" else clocks[1]
        clocks = gyro_clock(scene, clocks[0]), camera
        if scene.window.span_s > 0.9 * WINDOW_S:
            learnt = replace(learnt, gyro_clock=clocks[0], camera_clock=clocks[1], clocks_t=last)
    open_kinds = {account.kind for account in plain.accounts if account.cost} - learnt.settled
    story = _best(scene, learnt, plain) if open_kinds else _Story(0.0, ())
    accounts = [*story.accounts, orbit_account(scene, other)]
    accounts += [clocks[0].account(CLOCK_OF_GYRO), clocks[1].account(CLOCK_OF_CAMERA)]
    before = len(learnt.findings)
    learnt = _with_doubts(learnt, accounts, now)
    learnt = replace(learnt, compared=_compared(learnt, plain, accounts[-3:]))
    if open_kinds and len(learnt.findings) > before:
        learnt = replace(learnt, settled=learnt.settled | open_kinds)
    return learnt if plain.cost else _with_exclusions(scene, learnt)


def _best(scene: Scene, learnt: Learnt, plain: _Story) -> _Story:
    """The story with the fewest wrong conventions; the plain one where others are no better."""
    stories = [plain]
    stories += [_story(scene, star, pose, learnt) for star in READINGS_OF_QUATERNIONS for pose in READINGS_OF_POSES]
    stories += [_story(scene, star, READINGS_OF_POSES[0], learnt) for star in MOUNTINGS]
    return min(stories, key=lambda story: (round(story.cost, 3), sum(a.chi2 for a in story.accounts)))


def _story(scene: Scene, star: Convention, pose: PoseConvention, learnt: Learnt) -> _Story:
    accounts = [
        gyro_account(scene, star, learnt.gyro_excluded), baseline_account(scene, star, pose, learnt.gnss_excluded),
        attitude_account(scene, star, pose), keypoint_account(scene, pose),
    ]  # fmt: skip
    if star.name:
        cost = 1.0 if star in READINGS_OF_QUATERNIONS else 1.2
        accounts.append(Account(cost, "star tracker", f"the quaternions of the star tracker look {star.name}"))
    if pose.name:
        accounts.append(Account(1.0, "poses", f"the quaternions of the poses look {pose.name}"))
    return _Story(sum(account.cost for account in accounts), tuple(accounts))


def _with_doubts(learnt: Learnt, accounts: list[Account], now: float) -> Learnt:
    """Named causes are findings at once, those without a name when they stay."""
    doubts, findings = dict(learnt.doubts), {f.kind: f for f in learnt.findings}
    named = any(0.0 < account.cost < _UNNAMED for account in accounts)
    met = set()
    for account in accounts:
        if account.cost == 0.0:
            continue
        met.add(account.kind)
        doubts[account.kind] = doubts.get(account.kind, 0) + 1
        is_sure = account.cost < _UNNAMED or (doubts[account.kind] >= _AGAIN and not named)
        if is_sure and account.kind not in findings:
            findings[account.kind] = Finding(now, account.kind, account.cause)
    kept = tuple((kind, count) for kind, count in doubts.items() if kind in met)
    return replace(learnt, findings=tuple(findings.values()), doubts=kept)


def _compared(learnt: Learnt, plain: _Story, others: list[Account]) -> tuple[str, ...]:
    accounts = zip(_NAMES, [*plain.accounts, *others], strict=True)
    return tuple(sorted({*learnt.compared, *(name for name, account in accounts if account.is_compared)}))


_NAMES = (
    "gyro and star tracker", "GNSS and camera", "poses and held attitude", "poses and keypoints",
    "both ephemerides", "clocks of gyro and star tracker", "clocks of camera and star tracker",
)  # fmt: skip


def _with_exclusions(scene: Scene, learnt: Learnt) -> Learnt:
    """Conventions that do clearly worse than the plain one, which holds, are no longer of account."""
    gyro = _worse(gyro_fit(scene, AS_ASKED), learnt.gyro_excluded)
    gnss = _worse(baseline_fit(scene, AS_ASKED, READINGS_OF_POSES[0]), learnt.gnss_excluded)
    return replace(learnt, gyro_excluded=gyro, gnss_excluded=gnss)


def _worse(found: Fit | None, known: frozenset[int]) -> frozenset[int]:
    if found is None:
        return known
    return known | {k for k in range(1, len(found.chi2)) if found.chi2[k] > found.chi2[0] + CLEARLY}
