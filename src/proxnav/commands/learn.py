"""`proxnav learn`: from a mission to a model folder with a measured table and a report."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class LearnConfig:
    """Draws, learns, exports, calibrates and measures a model of a mission; stop and resume it at any moment.

    More --hours continue a finished one. The folder holds model/, and a run with report.html for each renderer.
    """

    mission: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="MISSION")]
    """Name of a shipped mission, or a TOML file: docs/missions.md"""
    out: Path
    """Folder of the training; the same command resumes it."""
    hours: float = 1.0
    """Time of all parts of the training together; export and measuring come on top."""
    target: str | None = None
    """Name or file of the target; the mission's when not given."""
    workers: int = 0
    """Processes that draw; 0 takes one a processor."""
    calibration: int = 150
    """Fresh ray-cast frames on which covariances are scaled."""
    raycast: int = 100
    """Ray-cast frames that the model is measured on."""
    cycles: int = 12
    """Frames of Cycles that it is measured on; 0 where Blender is not installed."""


def run(config: LearnConfig) -> None:
    """Learns, and prints the measured tables."""
    from dataclasses import replace

    from proxnav.cli.progress import progress, say_when_compiling
    from proxnav.learning.learn import Effort, learn
    from proxnav.missions import load_mission

    mission = load_mission(config.mission)
    mission = mission if config.target is None else replace(mission, target=config.target)
    effort = Effort(config.hours, config.calibration, config.raycast, config.cycles, config.workers)
    say_when_compiling("rendering", "pose")
    for renderer, judgement in learn(mission, config.out, effort, config, progress).items():
        print(f"\n{renderer}, {len(judgement.frames)} frames, {config.out / renderer / 'report.html'}\n")
        print(judgement.text())
    print(f"\nproxnav estimate IMAGES --model {config.out / 'model'}")
