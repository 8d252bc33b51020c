"""`proxnav navigate`: sensor records to a navigation solution with covariance."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro

from proxnav.datasets.files import write_atomic, write_json
from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.errors import NavErrors, mean_nis, nav_errors, outcomes
from proxnav.navigation.navigator import run_filter, scene_of
from proxnav.navigation.record_files import read_records
from proxnav.navigation.smoother import smooth
from proxnav.navigation.solution_files import csv_text, solution_columns
from proxnav.navigation.truth_files import TrueStates, read_truth
from proxnav.targets.loading import load_target


@dataclass(frozen=True)
class NavigateConfig:
    """Runs the filter over a records folder: solution.csv and .parquet, summary.json, errors where truth is known."""

    records: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="RECORDS")]
    """Folder with records.json and one csv per sensor, as `proxnav simulate` writes it."""
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
    filter: NavigationConfig = field(default_factory=NavigationConfig)


def main(argv: list[str]) -> None:
    """Entry of `proxnav navigate`."""
    config = tyro.cli(NavigateConfig, args=argv, prog="proxnav navigate")
    if not config.step_s > 0.0:
        raise InputError(f"--step-s must be positive, found {config.step_s:g}")
    out = config.out or config.records
    camera = Camera.from_speed_json(str(config.camera or config.records / "camera.json"))
    read = read_records(config.records)
    scene = scene_of(read.records, load_target(config.target).keypoints_m, camera, config.filter)
    frames = read.records.keypoints or read.records.poses
    assert frames is not None
    times = np.arange(frames.t.min(), frames.t.max() + config.step_s, config.step_s)
    truth = _truth(config)
    if truth is not None:
        times = times[(times >= truth.t[0]) & (times <= truth.t[-1])]
    states, judged, last = run_filter(read.records, scene, times)
    errors = nav_errors(states, truth.at(times)) if truth is not None else None
    _write(out, "solution", solution_columns(states, errors))
    if config.smooth:
        smoothed = smooth(read.records, scene)
        inside = [s for s in smoothed if truth is None or truth.t[0] <= s.t <= truth.t[-1]]
        at = np.array([s.t for s in inside])
        _write(
            out, "smoothed", solution_columns(inside, nav_errors(inside, truth.at(at)) if truth is not None else None)
        )
    summary = {"rejected_rows": read.rejected, "readings": outcomes(judged), "starts": last.starts,
               "mean_nis": {kind: value for kind, (value, _) in mean_nis(judged, times[0] + 60.0).items()}}  # fmt: skip
    summary |= _accuracy(errors) if errors is not None else {}
    write_json(out / "summary.json", summary, indent=1)
    _say(out, states, read.rejected, last.starts, errors)


def _truth(config: NavigateConfig) -> TrueStates | None:
    if config.truth is not None:
        return read_truth(config.truth)
    beside = config.records / "truth.csv"
    return read_truth(beside) if beside.is_file() else None


def _write(out: Path, name: str, table: dict[str, list]) -> None:
    """Csv always, parquet where pyarrow is installed."""
    write_atomic(out / f"{name}.csv", csv_text(table).encode())
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        print(f"{name}.parquet not written: pyarrow is not installed (pip install pyarrow)")
        return
    parquet.write_table(pyarrow.table(table), out / f"{name}.parquet")


def _accuracy(errors: NavErrors) -> dict[str, Any]:
    """Root mean squares over the second half, when the filter has settled, and honesty over all of it."""
    settled = errors.t >= 0.5 * (errors.t[0] + errors.t[-1])
    rms = np.sqrt(np.nanmean(errors.errors[settled] ** 2, axis=0))
    return {
        "rms_position_m": rms[:3].tolist(), "rms_velocity_mps": rms[3:6].tolist(),
        "rms_attitude_deg": np.rad2deg(rms[6:9]).tolist(), "mean_nees_of_12": float(np.nanmean(errors.nees)),
        "inside_3_sigma": float(np.nanmean(errors.inside_3_sigma)),
    }  # fmt: skip


def _say(out: Path, states: list, rejected: Any, starts: int, errors: NavErrors | None) -> None:
    known = [state for state in states if state is not None]
    print(f"{len(known)} states of {len(states)} in {out / 'solution.csv'}; the filter started {starts} time(s)")
    for name, reasons in rejected.items():
        print(f"{name}.csv: left out {', '.join(f'{count} rows {reason}' for reason, count in reasons.items())}")
    if errors is not None and len(known):
        found = _accuracy(errors)
        position, turn = np.linalg.norm(found["rms_position_m"]), np.linalg.norm(found["rms_attitude_deg"])
        print(f"second half: position {position:.3f} m, attitude {turn:.3f} deg RMS; "
              f"inside 3 sigma {100 * found['inside_3_sigma']:.1f} %")  # fmt: skip
