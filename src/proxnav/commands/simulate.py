"""`proxnav simulate`: sensor records along a trajectory, on truth that no filter knows."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import tyro

from proxnav import presets
from proxnav.datasets.files import write_json
from proxnav.datasets.records import Trajectory
from proxnav.errors import InputError
from proxnav.geometry.camera_files import speed_json
from proxnav.navigation.record_files import write_records
from proxnav.navigation.simulate import SensingConfig, SimulationConfig, simulate
from proxnav.navigation.truth import TruthConfig
from proxnav.navigation.truth_files import true_states, write_truth
from proxnav.targets.loading import load_target
from proxnav.trajectories.read import read_trajectory
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.selection import select


@dataclass(frozen=True)
class SimulateConfig:
    """Flies both craft under J2 and drag near a trajectory and records every sensor as csv, with the truth beside."""

    out: Path
    """Folder of the records."""
    preset: str = "spiral-10-100m"
    """spiral-10-100m, approach-100-10m, hold-30m or spiral-200-350m."""
    trajectory: tuple[Path, ...] = ()
    """Trajectory file(s) in place of the preset: STK .e/.a/csv, MATLAB csv, Basilisk csv, CCSDS OEM/AEM."""
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    """What the trajectory files do not say themselves."""
    target: str = "space-rider"
    """Name or file of the target."""
    start_s: float = 0.0
    """First second of the trajectory to fly."""
    duration_s: float | None = None
    """How long; to the end when not given."""
    seed: int = 0
    """Same seed, same records."""
    truth: TruthConfig = field(default_factory=TruthConfig)
    sensing: SensingConfig = field(default_factory=SensingConfig)


def main(argv: list[str]) -> None:
    """Entry of `proxnav simulate`."""
    config = tyro.cli(SimulateConfig, args=argv, prog="proxnav simulate")
    reference = cut(_reference(config), config.start_s, config.duration_s)
    camera, target = presets.NAVIGATION_CAMERA, load_target(config.target)
    simulation = SimulationConfig(config.truth, config.sensing)
    truth, records = simulate(reference, target, camera, simulation, np.random.default_rng(config.seed))
    write_records(config.out, records)
    every = max(1, round(1.0 / truth.step_s))
    write_truth(config.out / "truth.csv", true_states(truth, every))
    write_json(config.out / "camera.json", speed_json(camera), indent=1)
    ranges = np.linalg.norm(truth.relative[0], axis=1)
    frames = 0 if records.keypoints is None else len(records.keypoints.t)
    span = f"{truth.t[-1] - truth.t[0]:.0f} s at {ranges.min():.1f} to {ranges.max():.1f} m"
    print(f"{span}, {frames} frames in {config.out}")


def cut(reference: Trajectory, start_s: float, duration_s: float | None) -> Trajectory:
    """The instants of a trajectory from `start_s` for `duration_s`."""
    end = np.inf if duration_s is None else start_s + duration_s
    keep = (reference.t >= start_s - 1e-9) & (reference.t <= end + 1e-9)
    if keep.sum() < 2:
        raise InputError(
            f"--start-s {start_s:g} and --duration-s leave {keep.sum()} instants of a trajectory from "
            f"{reference.t[0]:g} to {reference.t[-1]:g} s; at least 2 are needed"
        )
    return select(reference, np.flatnonzero(keep))


def _reference(config: SimulateConfig) -> Trajectory:
    if config.trajectory:
        return read_trajectory([str(path) for path in config.trajectory], config.reader)
    return presets.flight(config.preset)
