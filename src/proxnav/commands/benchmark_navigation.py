"""`proxnav benchmark navigation`: Monte Carlo of the filter on truth that it does not know."""

import json
import os
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import tyro

from proxnav import presets
from proxnav.cluster.local import run_jobs
from proxnav.commands.progress import progress
from proxnav.datasets.files import write_json
from proxnav.navigation.config import FilterNoise, NavigationConfig
from proxnav.navigation.faults import Fault
from proxnav.navigation.monte_carlo import Case, RunJob, RunResult, judge_fault, summarise
from proxnav.navigation.simulate import Grade, SensingConfig, SimulationConfig
from proxnav.navigation.speed import measure_speed
from proxnav.navigation.truth import TruthConfig

Part = Literal["consistency", "accuracy", "faults", "speed"]

FAULTS: dict[Fault, float] = {
    "wrong_frames": 900.0, "camera_lost": 1500.0, "gnss_lost": 900.0, "gyro_step": 900.0, "late_camera": 900.0,
    "disorder": 900.0, "half_orbit_dark": 3600.0,
}  # fmt: skip
"""Length of the runs with each fault [s]."""


@dataclass(frozen=True)
class NavigationBenchmarkConfig:
    """Runs of pieces of the spiral 10-100 m and of the approach 100-10 m through the filter."""

    parts: tuple[Part, ...] = ("consistency", "accuracy", "faults", "speed")
    runs: int = 200
    """Flights for each line of the tables."""
    seed: int = 0
    workers: int = 2
    """Processes."""
    only: str = ""
    """Only lines whose name holds this text."""
    json: bool = False
    """Print JSON only."""
    out: Path | None = None
    """Folder for navigation_<part>.json."""


def main(argv: list[str]) -> None:
    """Entry of `proxnav benchmark navigation`."""
    config = tyro.cli(NavigationBenchmarkConfig, args=argv, prog="proxnav benchmark navigation")
    for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
        os.environ.setdefault(name, "1")  # the workers' own: one core each
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
        for coupling in ("tight", "loose")
    }
    return _table("consistency", lines, lambda name, job: summarise(_run(name, job, "none", config)), config)


def accuracy(config: NavigationBenchmarkConfig) -> dict[str, Any]:
    """What each sensor adds; every line has the star tracker, without which nothing is known in orbit axes."""
    lines = {
        "camera": _job("spiral-10-100m", 1800.0, "none", gyro=False),
        "camera + gyro": _job("spiral-10-100m", 1800.0, "none"),
        "camera + gyro + code GNSS": _job("spiral-10-100m", 1800.0, "code"),
        "camera + gyro + carrier GNSS": _job("spiral-10-100m", 1800.0, "carrier"),
    }
    return _table("accuracy", lines, lambda name, job: summarise(_run(name, job, "none", config)), config)


def faults(config: NavigationBenchmarkConfig) -> dict[str, Any]:
    """Each fault alone, tight coupling with gyro and code GNSS."""
    jobs = {name: _job("spiral-10-100m", seconds, "code") for name, seconds in FAULTS.items()}
    return _table("faults", jobs, lambda name, job: judge_fault(_run(name, job, name, config)), config)


def speed(_: NavigationBenchmarkConfig) -> dict[str, Any]:
    """Time of one prediction and one update with 24 keypoints on one core."""
    return measure_speed(presets.NAVIGATION_CAMERA, "space-rider")


def _table(
    part: Part, jobs: dict[Any, RunJob], measure: Callable[[Any, RunJob], Any], config: NavigationBenchmarkConfig
) -> dict[str, Any]:
    """Line by line, each written as soon as it is measured: an interrupted run keeps what it has."""
    found: dict[str, Any] = {}
    for name, job in jobs.items():
        if config.only not in name:
            continue
        found[name] = measure(name, job)
        if config.out is not None:
            write_json(config.out / f"navigation_{part}.json", found, indent=1)
    return found


def _job(
    flight: str, seconds: float, gnss: Grade, coupling: Literal["tight", "loose"] = "tight", gyro: bool = True
) -> RunJob:
    noise = replace(FilterNoise(), gnss_bias_m=0.03, gnss_tau_s=600.0) if gnss == "carrier" else FilterNoise()
    truth = TruthConfig(step_s=0.5, burn_interval_s=30.0 if flight.startswith("approach") else 600.0)
    return RunJob(
        presets.flight(flight), seconds, "space-rider", presets.NAVIGATION_CAMERA,
        SimulationConfig(truth, SensingConfig(gnss=gnss)), NavigationConfig(coupling=coupling, gyro=gyro, noise=noise),
    )  # fmt: skip


def _run(name: str, job: RunJob, fault: Fault, config: NavigationBenchmarkConfig) -> list[RunResult]:
    cases = [Case(name, config.seed + k, fault) for k in range(config.runs)]
    results: dict[int, RunResult] = {}
    with progress(name, len(cases)) as done:
        for case, result in run_jobs(job, cases, config.workers):
            results[case.seed] = result
            done()
    shortest = min(len(r.nees) for r in results.values())
    return [_cut(results[case.seed], shortest) for case in cases]


def _cut(result: RunResult, n: int) -> RunResult:
    names = ("range_m", "errors", "sigmas", "nees", "status")
    return replace(result, **{name: np.asarray(getattr(result, name))[:n] for name in names})
