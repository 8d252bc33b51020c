"""`proxnav benchmark navigation`: Monte Carlo of the filter on truth that it does not know."""

import json
from dataclasses import dataclass
from pathlib import Path

from proxnav.benchmarks.navigation_parts import Part
from proxnav.cli.options import WorkerOptions


@dataclass(frozen=True)
class NavigationBenchmarkConfig(WorkerOptions):
    """Runs of pieces of the spiral 10-100 m and of the approach 100-10 m through the filter."""

    parts: tuple[Part, ...] = ("consistency", "accuracy", "faults", "speed")
    runs: int = 200
    """Flights for each line of the tables."""
    seed: int = 0
    workers: int = 2
    """Processes; on a Ray cluster, 0 takes every processor."""
    only: str = ""
    """Only lines whose name holds this text."""
    json: bool = False
    """Print JSON only."""
    out: Path | None = None
    """Folder for navigation_<part>.json, and runs/ with every run, from which an interrupted benchmark goes on."""


def run(config: NavigationBenchmarkConfig) -> None:
    """Measures and prints the tables."""
    from proxnav.benchmarks.campaign import Campaign
    from proxnav.benchmarks.navigation import measure_navigation
    from proxnav.cli.progress import progress

    campaign = Campaign(config.runs, config.seed, config.workers, config.on, config.only, config.out, progress)
    print(json.dumps(measure_navigation(config.parts, campaign), indent=1))
