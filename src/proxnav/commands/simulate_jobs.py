"""Flights as jobs: a seed to the files of its records, in this process or in a worker that sees no file of ours."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Literal

import numpy as np

from proxnav.cli.progress import progress
from proxnav.closed_loop import ClosedLoopConfig, closed_loop, frame_times
from proxnav.cluster.carried import Carried
from proxnav.commands.many_runs import Named, files_of
from proxnav.datasets.sensor_records.files import write_records
from proxnav.flight.simulate import SensingConfig, SimulationConfig, sense, simulate
from proxnav.flight.truth import Truth, TruthConfig, simulate_truth
from proxnav.flight.truth_files import true_states, write_truth
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import speed_json
from proxnav.navigation.config import NavigationConfig
from proxnav.records import SensorRecords, Trajectory
from proxnav.storage.files import write_json
from proxnav.storage.run_record import run_record
from proxnav.targets import Target

Told = AbstractContextManager[Callable[[], None]]


@dataclass(frozen=True)
class Flight:
    """What one seed makes a flight of."""

    reference: Trajectory
    target: Target
    lens: Camera
    camera: Literal["model", "raycast"]
    estimator: str
    truth: TruthConfig
    sensing: SensingConfig
    threads: int = 0
    """Of the closed loop's network; 0 takes all cores."""

    def fly(self, seed: int, told: Callable[[str, int], Told] = progress) -> tuple[Truth, SensorRecords]:
        """Truth and records; `told` is asked whom to tell of each frame of a closed loop."""
        rng, camera = np.random.default_rng(seed), self.lens
        if self.camera == "model":
            return simulate(self.reference, self.target, camera, SimulationConfig(self.truth, self.sensing), rng)
        truth = simulate_truth(self.reference, replace(self.truth, camera_up="zenith"), rng)
        deaf = replace(sense(truth, self.target, camera, self.sensing, rng), keypoints=None, poses=None)
        loop = ClosedLoopConfig(self.estimator, self.sensing.detector.rate_hz, seed=seed, threads=self.threads)
        with told("closed loop", len(frame_times(truth, loop))) as done:
            return truth, closed_loop(truth, deaf, camera, NavigationConfig(), loop, done)


def write_flight(folder: Path, truth: Truth, records: SensorRecords, camera: Camera, options: object) -> None:
    """Records, truth, camera and, last, config.json of the options that it was flown with."""
    write_records(folder, records)
    write_truth(folder / "truth.csv", true_states(truth, max(1, round(1.0 / truth.step_s))))
    write_json(folder / "camera.json", speed_json(camera), indent=1)
    write_json(folder / "config.json", run_record(options), indent=1)


@dataclass(frozen=True)
class FlightJob:
    """Builds, once per process, the function from (name, options of a flight) to its files. Can be pickled.

    The options are those of `proxnav simulate`, with the seed.
    """

    flight: Flight
    model: str | Carried
    """The closed loop's, by name or as it travels."""

    def __call__(self) -> Callable[[Named], Carried]:
        place = None if isinstance(self.model, str) else self.model.unpacked()
        flight = replace(self.flight, estimator=self.model if place is None else place.name, threads=1)
        return _Fly(flight, place)


@dataclass(frozen=True)
class _Fly:
    flight: Flight
    place: TemporaryDirectory[str] | None
    """Of the model, which lies there as long as this lives."""

    def __call__(self, run: Named) -> Carried:
        options = run[1]
        truth, records = self.flight.fly(options.seed, lambda job, total: nullcontext(lambda: None))
        return files_of(lambda folder: write_flight(folder, truth, records, self.flight.lens, options))
