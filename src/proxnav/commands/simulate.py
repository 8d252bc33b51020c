"""`proxnav simulate`: sensor records along a trajectory, on truth that no filter knows."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import MissionOptions, TrajectoryOptions, WorkerOptions
from proxnav.flight.simulate import Detector, SensingConfig
from proxnav.flight.truth import TruthConfig


@dataclass(frozen=True, kw_only=True)
class SimulateConfig(MissionOptions, TrajectoryOptions, WorkerOptions):
    """Flies both craft under J2 and drag near a trajectory and records every sensor as csv, with the truth beside."""

    out: Path
    """Folder of the records."""
    mission: Annotated[str, tyro.conf.arg(aliases=("--preset",))] = "spiral-10-100m"
    """Name of a shipped mission with a trajectory, or a TOML file: docs/missions.md"""
    start_s: float = 0.0
    """First second of the trajectory to fly."""
    duration_s: float | None = None
    """How long; to the end when not given."""
    seed: int = 0
    """Same seed, same records."""
    detector: Detector = "modelled"
    """modelled: by the statistics of its errors; raycast: frames are rendered and read in the loop."""
    estimator: str = "space-rider"
    """Model that reads the rendered frames."""
    runs: int = 1
    """Flights of as many seeds from --seed on; more than one go into OUT/SEED each."""
    truth: TruthConfig = field(default_factory=TruthConfig)
    sensing: SensingConfig = field(default_factory=SensingConfig)


def run(config: SimulateConfig) -> None:
    """Flies once, or as often as asked for."""
    from proxnav.cli.progress import progress
    from proxnav.errors import InputError
    from proxnav.flights import FlightPlan, flight_text, fly_many, write_flight
    from proxnav.missions import MISSION, fly_mission, write_mission
    from proxnav.missions.changes import along
    from proxnav.missions.daylight import seen_at_all
    from proxnav.models.loading import carried_model
    from proxnav.targets.loading import load_target
    from proxnav.trajectories.selection import clip_time

    if config.runs < 1 or config.seed < 0:
        raise InputError(f"--runs must be at least 1 and --seed at least 0, found {config.runs} and {config.seed}")
    mission = along(config.read_mission(), config.trajectory, config.reader)
    reference = clip_time(fly_mission(mission), config.start_s, config.duration_s)
    if config.detector == "raycast":
        seen_at_all(reference)
    plan = FlightPlan(
        reference,
        load_target(mission.target),
        mission.camera,
        config.detector,
        config.estimator,
        config.truth,
        config.sensing,
    )
    if config.runs > 1:
        fly_many(plan, carried_model(config.estimator, config.on), config, progress)
        write_mission(config.out / MISSION, mission)
        print(f"{config.runs} flights of {reference.t[-1] - reference.t[0]:.0f} s in {config.out}")
        return
    truth, records = plan.fly(config.seed, progress)
    write_flight(config.out, truth, records, plan.camera, config)
    write_mission(config.out / MISSION, mission)
    print(f"{flight_text(truth, records)} in {config.out}")
