"""Navigation solutions: records folders through the filter, in this process or as jobs in workers."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import is_elsewhere
from proxnav.cluster.many_runs import NamedRun, files_of, run_many
from proxnav.cluster.progress import Progress, silent
from proxnav.datasets.sensor_records.record_files import read_records
from proxnav.evaluation.doubts import doubts_of, events
from proxnav.evaluation.flight_accuracy import accuracy, accuracy_line, mean_accuracy
from proxnav.evaluation.navigation_errors import NavErrors, mean_nis, nav_errors, outcomes
from proxnav.evaluation.solution_files import solution_columns
from proxnav.flight.truth_files import TrueStates, read_truth
from proxnav.geometry import Camera
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.geometry.types import Points
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.navigator import navigated
from proxnav.navigation.smoother import smooth
from proxnav.records import NavState
from proxnav.storage.files import read_json, write_json
from proxnav.storage.tables import write_columns
from proxnav.viewing.plots import errors_in_3_sigma

SUMMARY = "summary.json"


@dataclass(frozen=True)
class SolutionOptions:
    """How a records folder becomes a solution; files that are not given lie beside the records."""

    keypoints_m: Points
    camera: Camera | None
    calibration_sigma: CalibrationSigma
    """What is not known about the camera; exact: as its file says."""
    truth: Path | None
    step_s: float
    smooth: bool
    filter: NavigationConfig


@dataclass(frozen=True, slots=True, eq=False)
class FlightSolution:
    """What the filter said, and how wrong it was where truth is known."""

    states: list[NavState | None]
    errors: NavErrors | None
    rejected: Mapping[str, Mapping[str, int]]
    """Rows of each sensor's file that were left out, by reason."""
    starts: int
    doubts: tuple[str, ...]
    """What speaks against the solution, a sentence each; none where nothing does."""

    def text(self, out: Path) -> str:
        """The solution in `out` for people."""
        known = sum(state is not None for state in self.states)
        lines = [
            f"{known} states of {len(self.states)} in {out / 'solution.csv'}; the filter started {self.starts} time(s)",
            *(f"SUSPECT: {doubt}" for doubt in self.doubts),
        ]
        for name, reasons in self.rejected.items():
            counts = ", ".join(f"{count} rows {reason}" for reason, count in reasons.items())
            lines.append(f"{name}.csv: left out {counts}")
        if self.errors is not None and known:
            lines.append(accuracy_line(accuracy(self.errors)))
        return "\n".join(lines)


def flights_in(folder: Path) -> list[Path]:
    """The records folders of a folder that is none itself, by name."""
    if (folder / "records.json").exists() or not folder.is_dir():
        return []
    return sorted(path.parent for path in folder.glob("*/records.json"))


def solve_flight(records: Path, how: SolutionOptions, out: Path, progress: Progress = silent) -> FlightSolution:
    """Filters the records and writes the solution into `out`, summary.json last."""
    beside = records / "camera.json"
    camera = how.camera or Camera.read(beside)
    sigma_in_poses = Camera.read(beside).calibration_sigma if beside.is_file() else camera.calibration_sigma
    if not how.calibration_sigma.is_exact:
        camera = replace(camera, calibration_sigma=how.calibration_sigma)
    read = read_records(records)
    setup = setup_of(read.records, how.keypoints_m, camera, how.filter, sigma_in_poses)
    frames = read.records.keypoints or read.records.poses
    assert frames is not None
    times = np.arange(frames.t.min(), frames.t.max() + how.step_s, how.step_s)
    truth = _truth(records, how)
    if truth is not None:
        times = times[(times >= truth.t[0]) & (times <= truth.t[-1])]
    with progress("navigate", len(times)) as done:
        found = navigated(read.records, setup, times, done)
    states = found.states
    errors = nav_errors(states, truth.at(times)) if truth is not None else None
    _write(out, "solution", states, errors)
    if errors is not None and np.isfinite(errors.nees).any():
        figure = errors_in_3_sigma(errors.t, errors.errors, errors.sigmas)
        figure.savefig(out / "errors.png", dpi=90)
    if how.smooth:
        smoothed = [s for s in smooth(read.records, setup) if truth is None or truth.t[0] <= s.t <= truth.t[-1]]
        at = np.array([s.t for s in smoothed])
        _write(out, "smoothed", smoothed, nav_errors(smoothed, truth.at(at)) if truth is not None else None)
    starts, doubts = found.belief.memory.starts, doubts_of(found)
    summary = {"verdict": "suspect" if doubts else "ok", "doubts": doubts, "starts": starts, **events(found),
               "rejected_rows": read.rejected, "readings": outcomes(found.judged),
               "mean_nis": {k: value for k, (value, _) in mean_nis(found.judged, times[0] + 60.0).items()}}  # fmt: skip
    summary |= accuracy(errors) if errors is not None and np.isfinite(errors.nees).any() else {}
    write_json(out / SUMMARY, summary, indent=1)
    return FlightSolution(states, errors, read.rejected, starts, doubts)


def solve_flights(
    flights: Sequence[Path], how: SolutionOptions, options: Any, progress: Progress = silent
) -> dict[str, Any]:
    """Each flight's solution in a folder of its name in `options.out`, and monte_carlo.json, which is returned."""
    runs = [(flight.name, flight) for flight in flights]
    send = _carried if is_elsewhere(options.on) else None
    run_many("navigate", SolveJob(how), runs, options, SUMMARY, send, progress)
    summaries = [read_json(options.out / name / SUMMARY, "the summary of a flight") for name, _ in runs]
    found = mean_accuracy(summaries)
    found["suspect"] = [name for (name, _), one in zip(runs, summaries, strict=True) if one["verdict"] != "ok"]
    write_json(options.out / "monte_carlo.json", found, indent=1)
    return found


@dataclass(frozen=True)
class SolveJob:
    """Builds, once per process, the function from a records folder to the files of its solution. Can be pickled."""

    how: SolutionOptions

    def __call__(self) -> Callable[[NamedRun], Carried]:
        return self._solve

    def _solve(self, run: NamedRun) -> Carried:
        _, records = run
        if isinstance(records, Carried):
            with records.unpacked() as folder:
                return files_of(lambda out: solve_flight(Path(folder), self.how, out))
        return files_of(lambda out: solve_flight(records, self.how, out))


def _carried(run: NamedRun) -> NamedRun:
    return run[0], Carried.of(run[1])


def _truth(records: Path, how: SolutionOptions) -> TrueStates | None:
    if how.truth is not None:
        return read_truth(how.truth)
    beside = records / "truth.csv"
    return read_truth(beside) if beside.is_file() else None


def _write(out: Path, name: str, states: Sequence[NavState | None], errors: NavErrors | None) -> None:
    """The states as csv, and as parquet where pyarrow is installed."""
    table = solution_columns(states, errors)
    write_columns(out / f"{name}.csv", table)
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        return
    parquet.write_table(pyarrow.table(table), out / f"{name}.parquet")
