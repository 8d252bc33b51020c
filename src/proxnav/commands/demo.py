"""`proxnav demo`: the whole chain, small: fly a stretch of the spiral, render, estimate, compare, fuse, report."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.rendering.config import Renderer


@dataclass(frozen=True)
class DemoConfig:
    """Flies a lit stretch of the spiral, renders it, estimates poses with shipped weights, fuses them, writes a report.

    The filter has GNSS, gyro and star tracker besides the poses.
    """

    out: Path = Path("out/demo")
    """Folder of the run."""
    mission: Annotated[str, tyro.conf.arg(aliases=("--preset",))] = "spiral-10-100m"
    """Name of a shipped mission with a trajectory, or a TOML file: docs/missions.md"""
    frames: int = 12
    renderer: Renderer = "cycles"
    """cycles (Blender) or raycast."""
    samples: int = 16
    """Cycles: samples per pixel."""
    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    seed: int = 0


def run(config: DemoConfig) -> None:
    """Runs the chain and prints its tables."""
    from proxnav import pipeline
    from proxnav.cli.progress import progress, say_when_compiling
    from proxnav.missions import load_mission
    from proxnav.rendering.config import FrameConfig

    mission, rendering = load_mission(config.mission), FrameConfig(config.renderer, config.samples)
    say_when_compiling("rendering", "pose", "navigation")
    done = pipeline.run(mission, config.frames, config.seed, rendering, config.model, config.out, config, progress)
    print(done.judgement.text())
    if done.solution is not None:
        print(f"\nfilter: {done.solution.text(config.out)}")
    print(f"\nlook at {config.out / 'report.html'} and {config.out / 'overlays'}")
