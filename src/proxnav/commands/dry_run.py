"""`--dry-run` of commands that still have one: a little of the job is done, timed, and scaled up."""

import os
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from proxnav.benchmarks.dry_run import Estimate, folder_bytes


def seconds_each(work: Callable[[Any], object], items: Sequence[Any]) -> float:
    """Of up to three items after one that is not counted, since it may compile; of that one where it is alone."""
    times = [time.perf_counter()]
    for item in items[:4]:
        work(item)
        times.append(time.perf_counter())
    return (times[-1] - times[1]) / (len(times) - 2) if len(times) > 2 else times[1] - times[0]


def of_runs(make: Callable[[Path], object], count: float, workers: int) -> Estimate:
    """As many runs as `count`, of which `make` does one into a folder: twice, since the first one compiles."""
    with TemporaryDirectory() as folder:
        times = [time.perf_counter()]
        for name in ("first", "second"):
            (Path(folder) / name).mkdir()
            make(Path(folder) / name)
            times.append(time.perf_counter())
        written = folder_bytes(Path(folder) / "second")
    lanes = max(1, min(workers, os.cpu_count() or 1))
    return Estimate((times[2] - times[1]) * count / lanes, written * count)
