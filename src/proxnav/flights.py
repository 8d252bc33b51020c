"""Simulated flights: what the sensors record along a trajectory for one seed, here or as a job in a worker."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from proxnav.closed_loop import ClosedLoopConfig, closed_loop, frame_times
from proxnav.cluster.carried import Carried
from proxnav.cluster.jobs import POOL
from proxnav.cluster.many_runs import NamedRun, files_of, run_many
from proxnav.cluster.progress import Progress, silent
from proxnav.datasets.sensor_records.record_files import write_records
from proxnav.flight.simulate import Detector, SensingConfig, SimulationConfig, sense, simulate
from proxnav.flight.truth import Truth, TruthConfig, simulate_truth
from proxnav.flight.truth_files import true_states, write_truth
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import speed_json
from proxnav.navigation.config import NavigationConfig
from proxnav.records import SensorRecords, Trajectory
from proxnav.storage.files import write_json
from proxnav.storage.run_record import run_record
from proxnav.targets import Target


@dataclass(frozen=True)
class FlightPlan:
    """What one seed makes a flight of."""

    reference: Trajectory
    target: Target
    camera: Camera
    detector: Detector
    model: str
    """Model that reads rendered frames, by name or folder."""
    truth: TruthConfig
    sensing: SensingConfig
    threads: int = 0
    """Threads of that model's network; 0 takes all cores."""

    def fly(self, seed: int, progress: Progress = silent) -> tuple[Truth, SensorRecords]:
        """The truth, and what the sensors recorded."""
        rng = np.random.default_rng(seed)
        if self.detector == "modelled":
            return simulate(self.reference, self.target, self.camera, SimulationConfig(self.truth, self.sensing), rng)
        truth = simulate_truth(self.reference, replace(self.truth, camera_up="zenith"), rng)
        blind = replace(sense(truth, self.target, self.camera, self.sensing, rng), keypoints=None, poses=None)
        loop = ClosedLoopConfig(self.model, self.sensing.detector.rate_hz, seed=seed, threads=self.threads)
        with progress("closed loop", len(frame_times(truth, loop))) as done:
            return truth, closed_loop(truth, blind, self.camera, NavigationConfig(), loop, done)


def write_flight(folder: Path, truth: Truth, records: SensorRecords, camera: Camera, options: Any) -> None:
    """Records, truth, camera and, last, config.json of the options that it was flown with."""
    write_records(folder, records)
    write_truth(folder / "truth.csv", true_states(truth, max(1, round(1.0 / truth.step_s))))
    write_json(folder / "camera.json", speed_json(camera), indent=1)
    write_json(folder / "config.json", run_record(options), indent=1)


def flight_text(truth: Truth, records: SensorRecords) -> str:
    """A flight's length, ranges and frames for people."""
    ranges = np.linalg.norm(truth.relative[0], axis=1)
    frames = 0 if records.keypoints is None else len(records.keypoints.t)
    return f"{truth.t[-1] - truth.t[0]:.0f} s at {ranges.min():.1f} to {ranges.max():.1f} m, {frames} frames"


def fly_many(plan: FlightPlan, model: str | Carried, options: Any, progress: Progress = silent) -> None:
    """`options.runs` flights of as many seeds from `options.seed` on, each in a folder of `options.out` named by it.

    `options` is a dataclass that also says `workers` and `on`; `model` is the plan's, by name or as it travels.
    """
    seeds, alone = range(options.seed, options.seed + options.runs), replace(options, workers=1, on=POOL, runs=1)
    runs = [(f"{seed:05d}", replace(alone, out=options.out / f"{seed:05d}", seed=seed)) for seed in seeds]
    run_many("simulate", FlightJob(plan, model), runs, options, last="config.json", progress=progress)


@dataclass(frozen=True)
class FlightJob:
    """Builds, once per process, the function from (name, options of a flight) to its files. Can be pickled.

    The options are a dataclass with the seed; config.json keeps them.
    """

    plan: FlightPlan
    model: str | Carried
    """The plan's model, by name or as it travels."""

    def __call__(self) -> Callable[[NamedRun], Carried]:
        if isinstance(self.model, str):
            return _Fly(replace(self.plan, model=self.model, threads=1), None)
        unpacked = self.model.unpacked()
        return _Fly(replace(self.plan, model=unpacked.name, threads=1), unpacked)


@dataclass(frozen=True)
class _Fly:
    plan: FlightPlan
    unpacked: TemporaryDirectory[str] | None
    """Folder of the model, which is there as long as this lives."""

    def __call__(self, run: NamedRun) -> Carried:
        _, options = run
        truth, records = self.plan.fly(options.seed)
        return files_of(lambda folder: write_flight(folder, truth, records, self.plan.camera, options))
