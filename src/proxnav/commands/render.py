"""`proxnav render`: a data set or a sequence, from a preset or a trajectory file."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated

import tyro

from proxnav import presets
from proxnav.commands.progress import progress
from proxnav.datasets.records import SceneSpec
from proxnav.errors import InputError
from proxnav.frames import FrameConfig, Renderer
from proxnav.pipeline import draw_scenes, follow, render
from proxnav.trajectories.read import read_trajectory
from proxnav.trajectories.readers.config import ReaderConfig


@dataclass(frozen=True)
class RenderConfig:
    """Renders labelled images into a data set folder; the same command resumes an interrupted run."""

    out: Path
    """Folder of the data set."""
    preset: str = "observation-10-100m"
    """observation-10-100m, study, spiral-10-100m, approach-100-10m or sroc-200-350m."""
    trajectory: tuple[Path, ...] = ()
    """Trajectory file(s) in place of the preset's poses: STK .e/.a/csv, MATLAB csv, Basilisk csv, CCSDS OEM/AEM."""
    reader: ReaderConfig = field(default_factory=ReaderConfig)
    """What the trajectory files do not say themselves."""
    target: str | None = None
    """Name or file of the target; the preset's when not given."""
    renderer: Renderer = "cycles"
    """cycles (Blender) or raycast."""
    frames: int | None = None
    """Number of frames; the preset's when not given."""
    seed: int = 0
    """Same seed, same data set."""
    size: int | None = None
    """Longer side of the image [px]; the preset's when not given."""
    samples: Annotated[int, tyro.conf.arg(metavar="N")] = 32
    """Cycles: samples per pixel."""
    workers: int = 1
    """Processes."""


def main(argv: list[str]) -> None:
    """Entry of `proxnav render`."""
    config = tyro.cli(RenderConfig, args=argv, prog="proxnav render")
    if config.workers < 1 or config.samples < 1 or (config.frames is not None and config.frames < 1):
        raise InputError("--workers, --samples and --frames must be at least 1")
    scenes = scenes_of(config)
    with progress("render", len(scenes)) as done:
        dataset = render(scenes, FrameConfig(config.renderer, config.samples), config.out, config.workers, done)
    print(f"{len(dataset)} frames in {config.out}")


def scenes_of(config: RenderConfig) -> list[SceneSpec]:
    """The scenes that a configuration asks for."""
    preset = presets.preset(config.preset)
    if config.target is not None:
        preset = replace(preset, target=config.target)
    frames = config.frames or preset.frames
    if config.trajectory:
        return follow(read_trajectory(config.trajectory, config.reader), preset, frames, config.seed, config.size)
    if preset.trajectory:
        return follow(presets.flight(preset.trajectory), preset, frames, config.seed, config.size)
    return draw_scenes(preset, frames, config.seed, config.size)
