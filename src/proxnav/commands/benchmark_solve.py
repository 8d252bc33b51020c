"""`proxnav benchmark solve`: keypoints to pose, beside OpenCV and PoseLib, in one run."""

import json
from dataclasses import dataclass
from pathlib import Path

import tyro

from proxnav.datasets.files import write_json
from proxnav.errors import InputError
from proxnav.pose.benchmark import benchmark_solve


@dataclass(frozen=True)
class SolveBenchmarkConfig:
    """Random cases with noise and outliers, solved by each solver in turn."""

    cases: int = 10_000
    seed: int = 0
    json: bool = False
    """Print JSON instead of a table."""
    out: Path | None = None
    """Folder for solve.json."""


def main(argv: list[str]) -> None:
    """Entry of `proxnav benchmark solve`."""
    config = tyro.cli(SolveBenchmarkConfig, args=argv, prog="proxnav benchmark solve")
    if config.cases < 1 or config.seed < 0:
        raise InputError(
            f"the benchmark needs at least 1 case and a seed from 0 on, found {config.cases}, {config.seed}"
        )
    found = benchmark_solve(config.cases, config.seed)
    if config.out is not None:
        write_json(config.out / "solve.json", found, indent=1)
    print(json.dumps(found, indent=1))
