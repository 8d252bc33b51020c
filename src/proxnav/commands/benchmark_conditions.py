"""`proxnav benchmark conditions`: the same model where the light, the camera or the view get worse, one at a time."""

from dataclasses import dataclass

from proxnav.cli.options import MissionOptions, ModelOptions, ResultOptions, WorkerOptions


@dataclass(frozen=True)
class ConditionsConfig(MissionOptions, ModelOptions, WorkerOptions, ResultOptions):
    """Ray-cast frames of the mission under each condition; every condition sees the same views where it can."""

    frames: int = 40
    """Frames under each condition."""
    empty: int = 200
    """Frames without a target."""
    seed: int = 500


def run(config: ConditionsConfig) -> None:
    """Measures and gives the table."""
    from proxnav.benchmarks.condition_table import measure_conditions, table
    from proxnav.cli.progress import progress

    found = measure_conditions(
        config.read_mission(), config.model, config.frames, config.empty, config.seed, config.backend,
        config.workers, config.on, progress,
    )  # fmt: skip
    config.give(found, "conditions", table)
