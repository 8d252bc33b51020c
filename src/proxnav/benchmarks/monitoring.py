"""What the monitor says of honest flights, and of the same flights with one convention read otherwise."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, get_args

import numpy as np

from proxnav.benchmarks.campaign import Campaign
from proxnav.benchmarks.monte_carlo import RunJob, piece
from proxnav.cluster.jobs import run_anywhere
from proxnav.errors import InputError
from proxnav.flight.faults import FAULTS, Fault, with_fault
from proxnav.flight.simulate import simulate
from proxnav.flight.truth import Truth
from proxnav.flight.wrong_records import Mistake, with_mistake
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.monitor.finding import Finding
from proxnav.navigation.monitor.monitor import Monitor
from proxnav.navigation.navigator import other_orbit
from proxnav.navigation.stream import monitored
from proxnav.records import SensorRecords
from proxnav.targets.loading import load_target

SHORT_S = 130.0
"""Duration of a flight with a mistake, which is there from the start."""


@dataclass(frozen=True)
class Watch:
    """One seed to be watched."""

    seed: int


@dataclass(frozen=True, slots=True)
class Seen:
    """Findings of one seed: time since the first reading and cause, by what was done to the records."""

    refused: dict[str, str]
    """Sentences of records that were not taken at all."""
    found: dict[str, list[tuple[float, str]]]


@dataclass(frozen=True)
class MonitorJob:
    """Builds, once per process, the function that watches a seed. Can be pickled."""

    flight: RunJob
    only: str
    """Only rows whose name holds this text."""

    def __call__(self) -> Callable[[Watch], Seen]:
        return lambda watch: _watched(watch, self.flight, self.only)


def monitoring(jobs: dict[str, RunJob], campaign: Campaign) -> dict[str, Any]:
    """For each kind of flight: findings on honest flights and with faults, and time to the finding of each mistake."""
    table = {}
    for name, job in jobs.items():
        watches = [Watch(campaign.seed + k) for k in range(campaign.runs)]
        with campaign.progress(name, len(watches)) as done:
            seen = []
            for _, one in run_anywhere(MonitorJob(job, campaign.only), watches, campaign.workers, campaign.on, str):
                seen.append(one)
                done()
        table[name] = _summed(seen)
    return table


def _watched(watch: Watch, job: RunJob, only: str) -> Seen:
    rng = np.random.default_rng((watch.seed, 20241101))
    truth, clean = simulate(piece(job, rng), load_target(job.target), job.camera, job.simulation, rng)
    found, refused = {}, {}
    for fault in FAULTS:
        if fault not in _LONG and only in _as_fault(fault):
            found[_as_fault(fault)] = _findings(with_fault(clean, fault, np.random.default_rng(watch.seed)), job, truth)
    brief = _brief(clean, float(truth.t[0]) + SHORT_S)
    for mistake in [name for name in get_args(Mistake) if name != "none" and only in name]:
        try:
            found[mistake] = _findings(with_mistake(brief, mistake), job, truth)
        except InputError as error:
            refused[mistake] = str(error)
    return Seen(refused, found)


_LONG = ("camera_lost", "half_orbit_dark")
"""Faults that need longer flights."""


def _as_fault(fault: Fault) -> str:
    return "honest" if fault == "none" else f"fault {fault}"


def _findings(records: SensorRecords, job: RunJob, truth: Truth) -> list[tuple[float, str]]:
    setup = setup_of(records, load_target(job.target).keypoints_m, job.camera, job.filter)
    monitor = Monitor(setup, other_orbit(records))
    for reading in monitored(records, setup):
        monitor.take(reading)
    found: Sequence[Finding] = monitor.learnt.findings
    return [(finding.t - float(truth.t[0]), finding.cause) for finding in found]


def _brief(records: SensorRecords, last: float) -> SensorRecords:
    """The first minutes of records; ephemerides whole."""
    cut = {}
    for name in ("gyro", "accelerometer", "gnss", "star_tracker", "keypoints", "poses"):
        if (data := getattr(records, name)) is not None:
            kept = data.t <= last
            cut[name] = type(data)(*(getattr(data, field)[kept] for field in data.__dataclass_fields__))
    return replace(records, **cut)


def _summed(seen: Sequence[Seen]) -> dict[str, Any]:
    rows = {}
    for name in dict.fromkeys(name for one in seen for name in (*one.found, *one.refused)):
        found = [one.found[name] for one in seen if name in one.found]
        first = [min(t for t, _ in findings) for findings in found if findings]
        causes: dict[str, int] = {}
        for findings in found:
            for _, cause in findings:
                causes[cause] = causes.get(cause, 0) + 1
        sentences = [one.refused[name] for one in seen if name in one.refused]
        rows[name] = {
            "runs": len(seen), "refused": len(sentences), "refused_because": sentences[0] if sentences else "",
            "suspect": len(first), "suspect_within_60_s": sum(t <= 60.0 for t in first),
            "latest_s": max(first, default=None), "causes": dict(sorted(causes.items(), key=lambda row: -row[1])),
        }  # fmt: skip
    return rows
