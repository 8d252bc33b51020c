"""`proxnav navigate`: sensor records to a navigation solution with covariance."""

from dataclasses import dataclass, field, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import CameraOptions, WorkerOptions
from proxnav.navigation.config import NavigationConfig


@dataclass(frozen=True)
class NavigateConfig(CameraOptions, WorkerOptions):
    """Runs the filter over a records folder: solution.csv and .parquet, summary.json.

    Where truth is known also errors, and errors.png that shows them in three standard deviations. A folder of flights
    gives each of them, and monte_carlo.json that sums them up.
    """

    records: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RECORDS")]
    """Folder with records.json and one csv per sensor, as `proxnav simulate` writes it, or a folder of such folders."""
    out: Path | None = None
    """Folder of the solution; the records folder when not given."""
    target: str | None = None
    """Name or file of the target whose keypoints the detector found; the records' mission says it, else space-rider."""
    truth: Path | None = None
    """truth.csv to compare with; the one beside the records when not given."""
    step_s: float = 1.0
    """Between rows of the solution."""
    smooth: bool = False
    """Also write smoothed.csv: every state from all measurements, earlier and later."""
    filter: NavigationConfig = field(default_factory=NavigationConfig)


def run(config: NavigateConfig) -> int:
    """Solves one flight, or each of a folder; the exit status is 3 where a solution is suspect."""
    from proxnav.cli.progress import progress, say_when_compiling
    from proxnav.errors import SUSPECT, InputError
    from proxnav.evaluation.flight_accuracy import accuracy_line
    from proxnav.missions import mission_in
    from proxnav.solutions import SolutionOptions, flights_in, solve_flight, solve_flights
    from proxnav.targets.loading import load_target

    if not config.records.is_dir():
        raise InputError(f"{config.records}: no such folder; give the records of a flight, as simulate writes them")
    flights = flights_in(config.records)
    if not config.step_s > 0.0:
        raise InputError(f"--step-s must be positive, found {config.step_s:g}")
    if flights and config.truth is not None:
        raise InputError("--truth is of one flight; each of several has its own truth.csv beside its records")
    if find_spec("pyarrow") is None:
        print("solution.parquet is not written: it needs pyarrow (pip install 'proxnav[parquet]')")
    camera = None if config.camera is None else config.camera_from(config.camera)
    mission = mission_in(config.records)
    target = config.target or ("space-rider" if mission is None else mission.target)
    keypoints_m, out = load_target(target).keypoints_m, config.out or config.records
    how = SolutionOptions(
        keypoints_m, camera, config.calibration_sigma, config.truth, config.step_s, config.smooth, config.filter
    )
    say_when_compiling("navigation")
    if not flights:
        solution = solve_flight(config.records, how, out, progress)
        print(solution.text(out))
        return SUSPECT if solution.doubts else 0
    found = solve_flights(flights, how, replace(config, out=out), progress)
    print(f"{found['flights']} flights in {out}, {found['starts']} starts")
    if found["with_truth"]:
        print(accuracy_line(found))
    if found["suspect"]:
        print(f"SUSPECT: {len(found['suspect'])} flights, {', '.join(found['suspect'][:5])}: see their summary.json")
    return SUSPECT if found["suspect"] else 0
