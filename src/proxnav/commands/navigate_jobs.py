"""One records folder through the filter: in this process, or as a job in a worker that sees no file of ours."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.cluster.carried import Carried
from proxnav.commands.many_runs import Named, files_of
from proxnav.datasets.sensor_records.files import read_records
from proxnav.evaluation.navigation_errors import NavErrors, mean_nis, nav_errors, outcomes
from proxnav.evaluation.solution_files import solution_columns
from proxnav.flight.truth_files import TrueStates, read_truth
from proxnav.geometry import Camera
from proxnav.geometry.types import Points
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.navigator import run_filter
from proxnav.navigation.smoother import smooth
from proxnav.records import NavState
from proxnav.storage.files import write_json
from proxnav.storage.tables import write_columns
from proxnav.viewing.plots import errors_in_3_sigma


@dataclass(frozen=True)
class Solving:
    """How a records folder becomes a solution; files that are not given lie beside the records."""

    keypoints_m: Points
    camera: Camera | None
    truth: Path | None
    step_s: float
    smooth: bool
    filter: NavigationConfig


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """What the filter said, and how wrong it was where truth is known."""

    states: list[NavState | None]
    errors: NavErrors | None
    rejected: Any
    starts: int


def solve_flight(
    records: Path, how: Solving, out: Path, progress: Callable[[int], Callable[[], None]] = lambda total: lambda: None
) -> Solved:
    """Filters the records and writes the solution, summary.json last; `progress` is told how many steps there are."""
    camera = how.camera or Camera.from_speed_json(str(records / "camera.json"))
    read = read_records(records)
    setup = setup_of(read.records, how.keypoints_m, camera, how.filter)
    frames = read.records.keypoints or read.records.poses
    assert frames is not None
    times = np.arange(frames.t.min(), frames.t.max() + how.step_s, how.step_s)
    truth = _truth(records, how)
    if truth is not None:
        times = times[(times >= truth.t[0]) & (times <= truth.t[-1])]
    states, judged, last = run_filter(read.records, setup, times, progress(len(times)))
    errors = nav_errors(states, truth.at(times)) if truth is not None else None
    _write(out, "solution", solution_columns(states, errors))
    if errors is not None and np.isfinite(errors.nees).any():
        figure = errors_in_3_sigma(errors.t, errors.errors, errors.sigmas)
        figure.savefig(out / "errors.png", dpi=90)
    if how.smooth:
        smoothed = smooth(read.records, setup)
        inside = [s for s in smoothed if truth is None or truth.t[0] <= s.t <= truth.t[-1]]
        at = np.array([s.t for s in inside])
        _write(
            out, "smoothed", solution_columns(inside, nav_errors(inside, truth.at(at)) if truth is not None else None)
        )
    summary = {"rejected_rows": read.rejected, "readings": outcomes(judged), "starts": last.memory.starts,
               "mean_nis": {kind: value for kind, (value, _) in mean_nis(judged, times[0] + 60.0).items()}}  # fmt: skip
    summary |= accuracy(errors) if errors is not None else {}
    write_json(out / "summary.json", summary, indent=1)
    return Solved(states, errors, read.rejected, last.memory.starts)


def _truth(records: Path, how: Solving) -> TrueStates | None:
    if how.truth is not None:
        return read_truth(how.truth)
    beside = records / "truth.csv"
    return read_truth(beside) if beside.is_file() else None


def _write(out: Path, name: str, table: dict[str, list]) -> None:
    """Csv always, parquet where pyarrow is installed."""
    write_columns(out / f"{name}.csv", table)
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        print(f"{name}.parquet not written: it needs pyarrow (pip install 'proxnav[parquet]')")
        return
    parquet.write_table(pyarrow.table(table), out / f"{name}.parquet")


def accuracy(errors: NavErrors) -> dict[str, Any]:
    """Root mean squares over the second half, when the filter has settled, and honesty over all of it."""
    settled = errors.t >= 0.5 * (errors.t[0] + errors.t[-1])
    rms = np.sqrt(np.nanmean(errors.errors[settled] ** 2, axis=0))
    return {
        "rms_position_m": rms[:3].tolist(), "rms_velocity_mps": rms[3:6].tolist(),
        "rms_attitude_deg": np.rad2deg(rms[6:9]).tolist(), "mean_nees_of_12": float(np.nanmean(errors.nees)),
        "inside_3_sigma": float(np.nanmean(errors.inside_3_sigma)),
    }  # fmt: skip


@dataclass(frozen=True)
class SolveJob:
    """Builds, once per process, the function from a records folder to the files of its solution. Can be pickled."""

    how: Solving

    def __call__(self) -> Callable[[Named], Carried]:
        return self._solve

    def _solve(self, run: Named) -> Carried:
        if isinstance(run[1], Carried):
            with run[1].unpacked() as folder:
                return files_of(lambda out: solve_flight(Path(folder), self.how, out))
        return files_of(lambda out: solve_flight(run[1], self.how, out))
