"""`proxnav train keypoint-rcnn`: the seed study's network, by its recipe or by one for two processor cores."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from proxnav.cli.options import DryRunOptions, MissionOptions


@dataclass(frozen=True, kw_only=True)
class TrainRcnnOptions(MissionOptions, DryRunOptions):
    """Trains Keypoint R-CNN into --out (checkpoints, learning curve), then exports it as a model into --out/model."""

    out: Path
    """Folder of the run; the same command resumes it."""
    mission: str = "observation-10-100m"
    """Name of a shipped mission, or a TOML file, for images drawn on line: docs/missions.md"""
    recipe: Literal["study", "study-small"] = "study-small"
    """study: as published, for a GPU; study-small: slim heads and small sides, for two cores."""
    data: Path | None = None
    """Data set to train on, a folder or shards (also s3://...); without it every image is ray-cast fresh."""
    validation: int = 0
    """Frames whose mean E_C chooses the weights: the last of a --data folder, else fresh; 0 takes the last weights."""
    validate_every: int = 0
    """Steps; 0 is an epoch of study, 500 of study-small."""
    patience: int = 0
    """Validations without a better one that end the run; 0: no end."""
    subset: str = "six"
    """Named keypoints of the target; empty takes all."""
    side: int = 320
    """study-small: pixels of the square that the network sees."""
    steps: int = 3000
    """study-small: optimiser steps of 16 images."""
    minutes: float = 0.0
    """Stop, resumable, after so long; 0 is no limit."""
    workers: int = 1
    """Processes that draw."""
    repeats: int = 4
    """Times that a drawn image is learnt from."""
    mask: bool = False
    """Train the mask head as well (Mask R-CNN)."""
    devices: int = 1
    """Processes, one for each accelerator; for more than one start the command under torchrun."""
    start: Path | None = None
    """Weights to start from: ImageNet's, or a backbone's."""
    calibration: int = 100
    """Fresh frames on which the covariances are fitted."""
    looks: int = 1
    """2: the model detects once more, in a crop round the first box; the study does not."""
    least_median_score: float = 0.6
    """Median score of the keypoints that the model finds; below it no pose."""


def run(options: TrainRcnnOptions) -> None:
    """Trains the network and exports it, or says what it would take."""
    from proxnav.cli.progress import progress
    from proxnav.detection.training.ranks import is_first_rank
    from proxnav.learning.dry_run import training_dry_run
    from proxnav.learning.rcnn_export import export_rcnn_model
    from proxnav.learning.rcnn_training import KeypointChoice, RcnnImages, RcnnRecipe, rcnn_training

    mission = options.read_mission()
    keypoints = KeypointChoice.of(mission.target, options.subset)
    images = RcnnImages(options.data, options.validation, options.workers, options.repeats)
    recipe = RcnnRecipe(
        options.recipe, options.side, options.steps, options.minutes, options.validate_every, options.patience,
        options.mask, options.devices, options.start,
    )  # fmt: skip
    training = rcnn_training(mission, keypoints, images, recipe)
    if options.dry_run:
        print(training_dry_run(training))
        return
    result = training.run(options.out, options)
    if is_first_rank():
        score = f", best mean E_C {result.best_score:.4f}" if options.validation else ""
        print(f"{result.reason}: {result.steps} steps, {result.samples} images{score}; {options.out / 'model'} follows")
        export_rcnn_model(
            result.model, mission, keypoints, options.out / "model", options.side, options.calibration, options.looks,
            options.least_median_score, progress,
        )  # fmt: skip
