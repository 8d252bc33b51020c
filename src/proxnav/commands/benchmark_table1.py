"""`proxnav benchmark table1`: pose errors on a fixed set of Cycles images, beside the study's."""

import json
from dataclasses import dataclass
from pathlib import Path

from proxnav.cli.options import MissionOptions, ModelOptions, WorkerOptions
from proxnav.rendering.config import FrameConfig, Renderer


@dataclass(frozen=True)
class Table1Config(MissionOptions, ModelOptions, WorkerOptions):
    """Renders the set of a seed once, estimates every image of it, compares with the truth."""

    out: Path = Path("out/table1")
    """Folder of the images (kept and reused) and of poses.json, truth.json, metrics.json, overlays/."""
    frames: int = 100
    seed: int = 100
    renderer: Renderer = "cycles"
    samples: int = 32
    """Cycles: samples per pixel."""
    json: bool = False
    """Print one JSON object instead of the tables."""


def run(config: Table1Config) -> None:
    """Renders, estimates, and prints the tables."""
    from proxnav.cli.progress import progress
    from proxnav.measured_set import measure_set
    from proxnav.missions import MISSION, write_mission
    from proxnav.missions.scenes import draw_scenes

    mission = config.read_mission()
    write_mission(config.out / MISSION, mission)
    judgement = measure_set(
        config.out, f"{mission.name}-{config.renderer}-{config.frames}-{config.seed}",
        draw_scenes(mission, config.frames, config.seed), FrameConfig(config.renderer, config.samples), config.model,
        config, config.backend, config.workers, config.on, progress,
    )  # fmt: skip
    print(json.dumps(judgement.metrics(), indent=1) if config.json else judgement.text())
