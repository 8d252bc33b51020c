"""Many flights of one kind, kept on disk: an interrupted campaign goes on where it stopped."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.benchmarks.monte_carlo import Case, Job, RunResult
from proxnav.benchmarks.run_files import fingerprint, read_runs, write_runs
from proxnav.cluster.jobs import POOL, run_anywhere
from proxnav.cluster.progress import Progress, silent
from proxnav.flight.faults import Fault
from proxnav.storage.files import read_json, write_json

_SAVE_EVERY = 10
_SERIES = ("range_m", "errors", "sigmas", "nees", "status")


@dataclass(frozen=True)
class Campaign:
    """How many flights, of which seeds, where they are flown and where their results are kept."""

    runs: int
    """Flights for each line of a table, of as many seeds from `seed` on."""
    seed: int = 0
    workers: int = 1
    on: str = POOL
    only: str = ""
    """Only lines whose name holds this text."""
    out: Path | None = None
    """Folder of the tables, and runs/ with every flight."""
    progress: Progress = silent

    def table(self, part: str, jobs: Mapping[Any, Job], row: Callable[[Any, Job], Any]) -> dict[str, Any]:
        """Line by line, each written as soon as it is measured: an interrupted run keeps what it has."""
        path = None if self.out is None else self.out / f"navigation_{part}.json"
        kept = self.only and path is not None and path.is_file()
        found: dict[str, Any] = read_json(path, "results") if kept and path is not None else {}
        for name, job in jobs.items():
            if self.only in name:
                found[name] = row(name, job)
                if path is not None:
                    write_json(path, found, indent=1)
        return found

    def flown(self, name: str, job: Job, fault: Fault = "none") -> list[RunResult]:
        """Results of all seeds, equally long; those of an interrupted run with the same options are taken over."""
        cases = [Case(name, self.seed + k, fault) for k in range(self.runs)]
        path = None if self.out is None else self.out / "runs" / f"{name.replace(' ', '-').replace(',', '')}.npz"
        results = {} if path is None else read_runs(path, fingerprint(job))
        waiting = [case for case in cases if case.seed not in results]
        with self.progress(name, len(waiting)) as done:
            for count, (case, result) in enumerate(run_anywhere(job, waiting, self.workers, self.on, _named), 1):
                results[case.seed] = result
                if path is not None and (count % _SAVE_EVERY == 0 or count == len(waiting)):
                    write_runs(path, results, fingerprint(job))
                done()
        shortest = min(len(results[case.seed].nees) for case in cases)
        return [_cut(results[case.seed], shortest) for case in cases]


def _named(case: Case) -> str:
    return f"{case.name}, seed {case.seed}"


def _cut(result: RunResult, n: int) -> RunResult:
    return replace(result, **{name: np.asarray(getattr(result, name))[:n] for name in _SERIES})
