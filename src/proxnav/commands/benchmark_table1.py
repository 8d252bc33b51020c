"""`proxnav benchmark table1`: pose errors on a fixed set of Cycles images, beside the study's."""

import json
from dataclasses import dataclass
from pathlib import Path

import tyro

from proxnav import presets
from proxnav.commands.estimate import estimate_images, find_images
from proxnav.commands.progress import progress
from proxnav.detection.sessions import Backend
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig, Renderer
from proxnav.pipeline import draw_scenes, judge, render, write_run


@dataclass(frozen=True)
class Table1Config:
    """Renders the set of a seed once, estimates every image of it, compares with the truth."""

    out: Path = Path("out/table1")
    """Folder of the images (kept and reused) and of poses.json, truth.json, metrics.json, overlays/."""
    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    frames: int = 100
    seed: int = 100
    preset: str = "observation-10-100m"
    renderer: Renderer = "cycles"
    samples: int = 32
    """Cycles: samples per pixel."""
    workers: int = 1
    backend: Backend = "auto"
    json: bool = False
    """Print one JSON object instead of the tables."""


def main(argv: list[str]) -> None:
    """Entry of `proxnav benchmark table1`."""
    config = tyro.cli(Table1Config, args=argv, prog="proxnav benchmark table1")
    estimator = PoseEstimator.load(config.model, config.backend)
    scenes = draw_scenes(presets.preset(config.preset), config.frames, config.seed)
    folder = config.out / f"{config.preset}-{config.renderer}-{config.frames}-{config.seed}"
    with progress("render", len(scenes)) as done:
        dataset = render(scenes, FrameConfig(config.renderer, config.samples), folder, config.workers, done)
    records = estimate_images(estimator, find_images(folder), dataset.camera)
    judgement = judge(records, dataset)
    write_run(config.out, judgement, dataset, estimator, config)
    print(json.dumps(judgement.metrics(), indent=1) if config.json else judgement.text())
