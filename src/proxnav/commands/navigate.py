"""`proxnav navigate`: sensor records to a navigation solution with covariance."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from proxnav.cli.options import WorkerOptions
from proxnav.cli.progress import progress, say_when_compiling
from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import is_elsewhere
from proxnav.commands.many_runs import Named, run_many
from proxnav.commands.navigate_jobs import Solved, SolveJob, Solving, accuracy, solve_flight
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.navigation.config import NavigationConfig
from proxnav.storage.files import read_json, write_json
from proxnav.targets.loading import load_target


@dataclass(frozen=True)
class NavigateConfig(WorkerOptions):
    """Runs the filter over a records folder: solution.csv and .parquet, summary.json.

    Where truth is known also errors, and errors.png that shows them in three standard deviations. A folder of flights
    gives each of them, and monte_carlo.json that sums them up.
    """

    records: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RECORDS")]
    """Folder with records.json and one csv per sensor, as `proxnav simulate` writes it, or a folder of such folders."""
    out: Path | None = None
    """Folder of the solution; the records folder when not given."""
    target: str = "space-rider"
    """Name or file of the target whose keypoints the detector found."""
    camera: Path | None = None
    """camera.json with the keys of SPEED+; the one beside the records when not given."""
    truth: Path | None = None
    """truth.csv to compare with; the one beside the records when not given."""
    step_s: float = 1.0
    """Between rows of the solution."""
    smooth: bool = False
    """Also write smoothed.csv: every state from all measurements, earlier and later."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on one flight."""
    filter: NavigationConfig = field(default_factory=NavigationConfig)


def run(config: NavigateConfig) -> None:
    """Entry of `proxnav navigate`."""
    if not config.step_s > 0.0:
        raise InputError(f"--step-s must be positive, found {config.step_s:g}")
    camera = None if config.camera is None else Camera.from_speed_json(str(config.camera))
    keypoints_m = load_target(config.target).keypoints_m
    how = Solving(keypoints_m, camera, config.truth, config.step_s, config.smooth, config.filter)
    flights = flights_in(config.records)
    if config.dry_run:
        print(dry_run(flights or [config.records], how, config.workers))
    elif flights:
        _solve_many(flights, how, config)
    else:
        _solve_one(how, config)


def flights_in(folder: Path) -> list[Path]:
    """The records folders of a folder that is none itself, by name."""
    if (folder / "records.json").exists() or not folder.is_dir():
        return []
    return sorted(path.parent for path in folder.glob("*/records.json"))


def _solve_one(how: Solving, config: NavigateConfig) -> None:
    say_when_compiling("navigation")
    out = config.out or config.records
    with ExitStack() as stack:
        solved = solve_flight(config.records, how, out, lambda total: stack.enter_context(progress("navigate", total)))
    _say(out, solved)


def _solve_many(flights: Sequence[Path], how: Solving, config: NavigateConfig) -> None:
    if config.truth is not None:
        raise InputError("--truth is of one flight; each of several has its own truth.csv beside its records")
    say_when_compiling("navigation")
    out = config.out or config.records
    runs = [(flight.name, flight) for flight in flights]
    run_many(
        "navigate",
        SolveJob(how),
        runs,
        replace(config, out=out),
        "summary.json",
        _sent if is_elsewhere(config.on) else None,
    )
    found = sums([read_json(out / name / "summary.json", "the summary of a flight") for name, _ in runs])
    write_json(out / "monte_carlo.json", found, indent=1)
    print(f"{found['flights']} flights in {out}, {found['starts']} starts")
    if "rms_position_m" in found:
        position, turn = found["rms_position_m"], found["rms_attitude_deg"]
        honest = (
            f"inside 3 sigma {100 * found['inside_3_sigma']:.1f} %, mean NEES of 12: {found['mean_nees_of_12']:.1f}"
        )
        print(f"second half: position {position:.3f} m, attitude {turn:.3f} deg RMS; {honest}")


def _sent(run: Named) -> Named:
    return run[0], Carried.of(run[1])


def sums(summaries: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Over the flights of which the truth is known: root mean squares [m, deg] of norms, means of the rest."""
    known = [s for s in summaries if s.get("rms_position_m") is not None]
    found: dict[str, Any] = {"flights": len(summaries), "with_truth": len(known)}
    found["starts"] = sum(s["starts"] for s in summaries)
    for name in ("rms_position_m", "rms_velocity_mps", "rms_attitude_deg"):
        if known:
            norms = np.linalg.norm(np.array([s[name] for s in known], dtype=np.float64), axis=1)
            found[name] = float(np.sqrt(np.nanmean(norms**2)))
            found[name.replace("rms", "p95")] = float(np.nanpercentile(norms, 95))
    for name in ("mean_nees_of_12", "inside_3_sigma"):
        if known:
            found[name] = float(np.nanmean(np.array([s[name] for s in known], dtype=np.float64)))
    return found


def dry_run(flights: Sequence[Path], how: Solving, workers: int) -> str:
    """Measured on the first flight."""
    from proxnav.commands.dry_run import of_runs

    estimate = of_runs(lambda folder: solve_flight(flights[0], how, folder), len(flights), workers)
    return estimate.text(f"{len(flights)} flight(s)")


def _say(out: Path, solved: Solved) -> None:
    known = [state for state in solved.states if state is not None]
    print(
        f"{len(known)} states of {len(solved.states)} in {out / 'solution.csv'}; "
        f"the filter started {solved.starts} time(s)"
    )
    for name, reasons in solved.rejected.items():
        print(f"{name}.csv: left out {', '.join(f'{count} rows {reason}' for reason, count in reasons.items())}")
    if solved.errors is not None and len(known):
        found = accuracy(solved.errors)
        position, turn = np.linalg.norm(found["rms_position_m"]), np.linalg.norm(found["rms_attitude_deg"])
        print(f"second half: position {position:.3f} m, attitude {turn:.3f} deg RMS; "
              f"inside 3 sigma {100 * found['inside_3_sigma']:.1f} %")  # fmt: skip
