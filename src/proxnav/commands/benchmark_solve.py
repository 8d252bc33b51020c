"""`proxnav benchmark solve`: keypoints to pose, beside OpenCV and PoseLib, in one run."""

import json
from dataclasses import dataclass

from proxnav.cli.options import ResultOptions


@dataclass(frozen=True)
class SolveBenchmarkConfig(ResultOptions):
    """Random cases with noise and outliers, solved by each solver in turn."""

    cases: int = 10_000
    seed: int = 0


def run(config: SolveBenchmarkConfig) -> None:
    """Measures and gives the table."""
    from proxnav.benchmarks.solve import benchmark_solve

    config.give(benchmark_solve(config.cases, config.seed), "solve", lambda found: json.dumps(found, indent=1))
