"""`proxnav benchmark table1`: pose errors on a fixed set of Cycles images, beside the study's."""

import json
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from proxnav.cli.progress import progress
from proxnav.cluster.jobs import POOL
from proxnav.commands.estimate import find_images, observe_anywhere
from proxnav.detection.sessions import Backend
from proxnav.estimator import PoseEstimator
from proxnav.evaluation.judgement import judge
from proxnav.frames import FrameConfig, Renderer
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import SceneSpec
from proxnav.rendered_set import render
from proxnav.viewing.run_writer import write_run


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
    target: str | None = None
    """Name or file of the target; the mission's when not given."""
    renderer: Renderer = "cycles"
    samples: int = 32
    """Cycles: samples per pixel."""
    workers: int = 1
    on: str = POOL
    """pool (processes of this machine), ray, or ray://host:port."""
    backend: Backend = "auto"
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    json: bool = False
    """Print one JSON object instead of the tables."""


def run(config: Table1Config) -> None:
    """Entry of `proxnav benchmark table1`."""
    estimator = PoseEstimator.load(config.model, config.backend)
    mission = load_mission(config.preset)
    mission = mission if config.target is None else replace(mission, target=config.target)
    scenes = draw_scenes(mission, config.frames, config.seed)
    if config.dry_run:
        print(dry_run(estimator, scenes, config))
        return
    folder = config.out / f"{config.preset}-{config.renderer}-{config.frames}-{config.seed}"
    with progress("render", len(scenes)) as done:
        dataset = render(scenes, FrameConfig(config.renderer, config.samples), folder, config.workers, done, config.on)
    records, keypoints = observe_anywhere(
        find_images(folder), dataset.camera, config.model, config.backend, config.workers, config.on
    )
    judgement = judge(records, dataset)
    write_run(config.out, judgement, dataset, estimator.points_target_m, keypoints, config)
    print(json.dumps(judgement.metrics(), indent=1) if config.json else judgement.text())


def dry_run(estimator: PoseEstimator, scenes: Sequence[SceneSpec], config: Table1Config) -> str:
    """Rendering and estimating, each measured on a few frames."""
    from proxnav.commands.dry_run import Estimate, of_rendering

    rendering = of_rendering(scenes, FrameConfig(config.renderer, config.samples), config.workers)
    image = np.zeros((scenes[0].camera.height, scenes[0].camera.width), np.uint8)
    estimator(image, scenes[0].camera)
    start = time.perf_counter()
    for _ in range(3):
        estimator(image, scenes[0].camera)
    # A blank image needs one look instead of two.
    estimating = Estimate(2.0 * (time.perf_counter() - start) / 3 * len(scenes), 2e3 * len(scenes))
    return (rendering + estimating).text(f"{len(scenes)} frames, rendered and estimated,")
