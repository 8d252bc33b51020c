"""One model's pose errors on a set of scenes, rendered once and kept."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from proxnav.cluster.jobs import POOL
from proxnav.cluster.progress import Progress, silent
from proxnav.detection.sessions import Backend
from proxnav.estimation import estimate_images
from proxnav.evaluation.judgement import Judgement, judge
from proxnav.frames import FrameConfig
from proxnav.models.loading import load_card
from proxnav.records import SceneSpec
from proxnav.rendered_set import render
from proxnav.viewing.run_writer import write_run


def measure_set(
    out: Path, name: str, scenes: Sequence[SceneSpec], frames: FrameConfig, model: str, options: Any,
    backend: Backend = "auto", workers: int = 1, on: str = POOL, progress: Progress = silent,
) -> Judgement:  # fmt: skip
    """Renders the scenes into `out/name` unless they are there, estimates every image, writes the run into `out`.

    `options` is the dataclass that the run was asked with, which config.json keeps.
    """
    points_m = load_card(model).keypoints_m
    with progress("render", len(scenes)) as done:
        dataset = render(scenes, frames, out / name, workers, done, on)
    images = dataset.image_paths
    with progress("estimate", len(images)) as done:
        records, keypoints = estimate_images(images, dataset.camera, model, backend, 0, workers, on, done)
    judgement = judge(records, dataset)
    write_run(out, judgement, dataset, points_m, keypoints, options)
    return judgement
