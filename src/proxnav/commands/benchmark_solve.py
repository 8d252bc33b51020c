"""`proxnav benchmark solve`: keypoints to pose, beside OpenCV and PoseLib, in one run."""

import json
import time
from dataclasses import dataclass
from pathlib import Path

from proxnav.benchmarks.solve import benchmark_solve
from proxnav.errors import InputError
from proxnav.storage.files import write_json


@dataclass(frozen=True)
class SolveBenchmarkConfig:
    """Random cases with noise and outliers, solved by each solver in turn."""

    cases: int = 10_000
    seed: int = 0
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    json: bool = False
    """Print JSON instead of a table."""
    out: Path | None = None
    """Folder for solve.json."""


def run(config: SolveBenchmarkConfig) -> None:
    """Entry of `proxnav benchmark solve`."""
    if config.cases < 1 or config.seed < 0:
        raise InputError(
            f"the benchmark needs at least 1 case and a seed from 0 on, found {config.cases}, {config.seed}"
        )
    if config.dry_run:
        print(dry_run(config))
        return
    found = benchmark_solve(config.cases, config.seed)
    if config.out is not None:
        write_json(config.out / "solve.json", found, indent=1)
    print(json.dumps(found, indent=1))


def dry_run(config: SolveBenchmarkConfig) -> str:
    """Measured on 50 cases, after one that compiles what has to be compiled."""
    from proxnav.commands.dry_run import Estimate

    benchmark_solve(1, config.seed)
    start = time.perf_counter()
    benchmark_solve(50, config.seed)
    return Estimate((time.perf_counter() - start) / 50 * config.cases, 2e3).text(f"{config.cases} cases")
