"""`proxnav simulate`: sensor records along a trajectory, on truth that no filter knows."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np

from proxnav.cli.options import WorkerOptions
from proxnav.commands.many_runs import run_many, single
from proxnav.commands.simulate_jobs import Flight, FlightJob, write_flight
from proxnav.errors import InputError
from proxnav.flight.simulate import SensingConfig
from proxnav.flight.truth import TruthConfig
from proxnav.missions import fly, load_mission
from proxnav.models.loading import carried_model
from proxnav.records import Trajectory
from proxnav.targets.loading import load_target
from proxnav.trajectories.read import read_trajectory
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.selection import select

_TRIED_S = 20.0
"""Of a flight, to say how long all of it would take."""


@dataclass(frozen=True)
class SimulateConfig(WorkerOptions):
    """Flies both craft under J2 and drag near a trajectory and records every sensor as csv, with the truth beside."""

    out: Path
    """Folder of the records."""
    preset: str = "spiral-10-100m"
    """spiral-10-100m, approach-100-10m, hold-30m or sroc-200-350m."""
    trajectory: tuple[Path, ...] = ()
    """Files in place of the mission's, docs/trajectories.md."""
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
    camera: Literal["model", "raycast"] = "model"
    """model: by statistics; raycast: closed loop."""
    estimator: str = "space-rider"
    """Closed loop: model."""
    runs: int = 1
    """Flights of as many seeds from --seed on; more than one go into OUT/SEED each."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    truth: TruthConfig = field(default_factory=TruthConfig)
    sensing: SensingConfig = field(default_factory=SensingConfig)


def run(config: SimulateConfig) -> None:
    """Entry of `proxnav simulate`."""
    if config.runs < 1 or config.seed < 0:
        raise InputError(f"--runs must be at least 1 and --seed at least 0, found {config.runs} and {config.seed}")
    reference = cut(_reference(config), config.start_s, config.duration_s)
    target = load_target(config.target)
    camera = load_mission(config.preset).camera
    flight = Flight(reference, target, camera, config.camera, config.estimator, config.truth, config.sensing)
    if config.dry_run:
        print(dry_run(flight, config))
        return
    if config.runs > 1:
        _fly_many(flight, config)
        return
    truth, records = flight.fly(config.seed)
    write_flight(config.out, truth, records, flight.lens, config)
    ranges = np.linalg.norm(truth.relative[0], axis=1)
    frames = 0 if records.keypoints is None else len(records.keypoints.t)
    span = f"{truth.t[-1] - truth.t[0]:.0f} s at {ranges.min():.1f} to {ranges.max():.1f} m"
    print(f"{span}, {frames} frames in {config.out}")


def _fly_many(flight: Flight, config: SimulateConfig) -> None:
    seeds = range(config.seed, config.seed + config.runs)
    runs = [(f"{seed:05d}", single(config, f"{seed:05d}", seed=seed, runs=1)) for seed in seeds]
    run_many(
        "simulate", FlightJob(flight, carried_model(config.estimator, config.on)), runs, config, last="config.json"
    )
    print(f"{config.runs} flights of {reference_s(flight.reference):.0f} s in {config.out}")


def dry_run(flight: Flight, config: SimulateConfig) -> str:
    """Measured on 20 s of the flight; every second of every flight counts the same."""
    from proxnav.commands.dry_run import of_runs

    piece = replace(flight, reference=cut(flight.reference, float(flight.reference.t[0]), _TRIED_S))
    share = reference_s(flight.reference) / reference_s(piece.reference)

    def try_one(folder: Path) -> None:
        write_flight(folder, *piece.fly(config.seed), flight.lens, config)

    estimate = of_runs(try_one, share * config.runs, config.workers)
    return estimate.text(f"{config.runs} flight(s) of {reference_s(flight.reference):.0f} s")


def reference_s(reference: Trajectory) -> float:
    """How long it lasts."""
    return float(reference.t[-1] - reference.t[0])


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
    mission = load_mission(config.preset)
    if not mission.flight.trajectory:
        raise InputError(
            f"mission '{mission.name}' has no trajectory to fly; spiral-10-100m has one, or give --trajectory"
        )
    return fly(mission.flight.trajectory)
