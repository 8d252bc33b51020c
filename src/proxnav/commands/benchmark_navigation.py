"""`proxnav benchmark navigation`: Monte Carlo of the filter on truth that it does not know."""

import json
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np

from proxnav.benchmarks.filter_speed import measure_speed
from proxnav.benchmarks.monte_carlo import Case, RunJob, RunResult, judge_fault, summarise
from proxnav.benchmarks.run_files import fingerprint, read_runs, write_runs
from proxnav.cli.progress import progress
from proxnav.cluster.jobs import POOL, run_anywhere
from proxnav.flight.faults import Fault
from proxnav.flight.sensors.star_tracker import StarTrackerConfig
from proxnav.flight.simulate import Grade, SensingConfig, SimulationConfig
from proxnav.flight.truth import TruthConfig
from proxnav.missions import fly, load_mission
from proxnav.navigation.config import FilterNoise, NavigationConfig
from proxnav.storage.files import read_json, write_json

_SAVE_EVERY = 10

Part = Literal["consistency", "accuracy", "faults", "speed"]

FAULTS: dict[Fault, float] = {
    "wrong_frames": 900.0, "camera_lost": 1200.0, "gnss_lost": 900.0, "gyro_step": 900.0, "late_camera": 900.0,
    "disorder": 900.0, "half_orbit_dark": 2760.0,
}  # fmt: skip
"""Length of the runs with each fault [s]; where the camera is lost, five minutes are left after it."""


@dataclass(frozen=True)
class NavigationBenchmarkConfig:
    """Runs of pieces of the spiral 10-100 m and of the approach 100-10 m through the filter."""

    parts: tuple[Part, ...] = ("consistency", "accuracy", "faults", "speed")
    runs: int = 200
    """Flights for each line of the tables."""
    seed: int = 0
    workers: int = 2
    """Processes; on a Ray cluster, 0 takes every processor."""
    on: str = POOL
    """pool (processes of this machine), ray, or ray://host:port."""
    only: str = ""
    """Only lines whose name holds this text."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    json: bool = False
    """Print JSON only."""
    out: Path | None = None
    """Folder for navigation_<part>.json, and runs/ with every run, from which an interrupted benchmark goes on."""


def run(config: NavigationBenchmarkConfig) -> None:
    """Entry of `proxnav benchmark navigation`."""
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # the workers' own: one core each
    if config.dry_run:
        print(dry_run(config))
        return
    parts: dict[Part, Callable[[NavigationBenchmarkConfig], Any]] = {
        "consistency": consistency, "accuracy": accuracy, "faults": faults, "speed": speed,
    }  # fmt: skip
    found = {}
    for part in config.parts:
        started = time.monotonic()
        found[part] = parts[part](config) | {"wall_s": time.monotonic() - started}
        if config.out is not None:
            write_json(config.out / f"navigation_{part}.json", found[part], indent=1)
    print(json.dumps(found, indent=1))


def consistency(config: NavigationBenchmarkConfig) -> dict[str, Any]:
    """Loose and tight coupling, on the spiral and on the approach, with correlated camera errors."""
    lines = {
        f"{flight}, {coupling}": _job(flight, 900.0, "code", coupling=coupling)
        for flight in ("spiral-10-100m", "approach-100-10m")
        for coupling in ("loose", "tight")
    }
    return _table("consistency", lines, lambda name, job: summarise(_run(name, job, "none", config)), config)


def accuracy(config: NavigationBenchmarkConfig) -> dict[str, Any]:
    """What each sensor adds; every line has the star tracker, without which nothing is known in orbit axes."""
    lines = {
        "camera": _job("spiral-10-100m", 900.0, "none", gyro=False),
        "camera + gyro": _job("spiral-10-100m", 900.0, "none"),
        "camera + gyro + code GNSS": _job("spiral-10-100m", 900.0, "code"),
        "camera + gyro + carrier GNSS": _job("spiral-10-100m", 900.0, "carrier"),
    }
    return _table("accuracy", lines, lambda name, job: summarise(_run(name, job, "none", config)), config)


def faults(config: NavigationBenchmarkConfig) -> dict[str, Any]:
    """Each fault alone, loose coupling with gyro and code GNSS; wrong frames, which differ, with tight coupling too."""
    jobs: dict[str, RunJob] = {name: _job("spiral-10-100m", seconds, "code") for name, seconds in FAULTS.items()}
    jobs["wrong_frames, tight"] = _job("spiral-10-100m", FAULTS["wrong_frames"], "code", coupling="tight")
    kinds: dict[str, Fault] = {"wrong_frames, tight": "wrong_frames", **{name: name for name in FAULTS}}
    return _table("faults", jobs, lambda name, job: judge_fault(_run(name, job, kinds[name], config)), config)


def speed(_: NavigationBenchmarkConfig) -> dict[str, Any]:
    """Time of one prediction and one update with 24 keypoints on one core."""
    return measure_speed(load_mission("spiral-10-100m").camera, "space-rider")


def dry_run(config: NavigationBenchmarkConfig) -> str:
    """Measured on 60 s of one flight; every second of every other flight counts the same."""
    from proxnav.commands.dry_run import Estimate

    _fly_60_s(config.seed)  # compiles what has to be compiled
    start = time.perf_counter()
    _fly_60_s(config.seed)
    each = (time.perf_counter() - start) / 60.0
    flown = {"consistency": 4 * 900.0, "accuracy": 4 * 900.0, "faults": sum(FAULTS.values()) + 900.0, "speed": 0.0}
    seconds = sum(flown[part] for part in config.parts) * config.runs
    lanes = min(config.workers, os.cpu_count() or 1)
    return Estimate(each * seconds / lanes, 1e4).text(f"{seconds / 3600:.0f} h of flight")


def _fly_60_s(seed: int) -> None:
    job = _job("spiral-10-100m", 60.0, "code")()
    job(Case("dry run", seed, "none"))


def _table(
    part: Part, jobs: dict[Any, RunJob], measure: Callable[[Any, RunJob], Any], config: NavigationBenchmarkConfig
) -> dict[str, Any]:
    """Line by line, each written as soon as it is measured: an interrupted run keeps what it has."""
    path = None if config.out is None else config.out / f"navigation_{part}.json"
    found: dict[str, Any] = read_json(path, "results") if config.only and path is not None and path.is_file() else {}
    for name, job in jobs.items():
        if config.only not in name:
            continue
        found[name] = measure(name, job)
        if path is not None:
            write_json(path, found, indent=1)
    return found


def _job(
    flight: str, seconds: float, gnss: Grade, coupling: Literal["loose", "tight"] = "loose", gyro: bool = True
) -> RunJob:
    noise = replace(FilterNoise(), gnss_bias_m=0.03, gnss_tau_s=600.0) if gnss == "carrier" else FilterNoise()
    truth = TruthConfig(step_s=1.0, burn_interval_s=30.0 if flight.startswith("approach") else 600.0)
    sensing = SensingConfig(gnss=gnss, star_tracker=StarTrackerConfig(rate_hz=1.0))
    mission = load_mission(flight)
    return RunJob(
        fly(mission.flight.trajectory), seconds, mission.target, mission.camera,
        SimulationConfig(truth, sensing), NavigationConfig(coupling=coupling, gyro=gyro, noise=noise),
    )  # fmt: skip


def _run(name: str, job: RunJob, fault: Fault, config: NavigationBenchmarkConfig) -> list[RunResult]:
    """Results of all seeds; those of an interrupted benchmark with the same options are taken over."""
    cases = [Case(name, config.seed + k, fault) for k in range(config.runs)]
    path = None if config.out is None else config.out / "runs" / f"{name.replace(' ', '-').replace(',', '')}.npz"
    results = {} if path is None else read_runs(path, fingerprint(job))
    waiting = [case for case in cases if case.seed not in results]
    with progress(name, len(waiting)) as done:
        for count, (case, result) in enumerate(run_anywhere(job, waiting, config.workers, config.on, _named), 1):
            results[case.seed] = result
            if path is not None and (count % _SAVE_EVERY == 0 or count == len(waiting)):
                write_runs(path, results, fingerprint(job))
            done()
    shortest = min(len(results[case.seed].nees) for case in cases)
    return [_cut(results[case.seed], shortest) for case in cases]


def _named(case: Case) -> str:
    return f"{case.name}, seed {case.seed}"


def _cut(result: RunResult, n: int) -> RunResult:
    names = ("range_m", "errors", "sigmas", "nees", "status")
    return replace(result, **{name: np.asarray(getattr(result, name))[:n] for name in names})
