"""`proxnav train heatmap` and `proxnav train finder`: every image is drawn fresh while the network learns."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from torch import nn

from proxnav.detection.heatmap.train import (
    TrainFinderConfig,
    TrainHeatmapConfig,
    keypoint_errors,
    train_finder,
    train_heatmap,
)
from proxnav.detection.samples import SampleSource, TrainingSample
from proxnav.errors import InputError
from proxnav.learning.crops import CropConfig, CropJob, WholeFrameJob, sample_source
from proxnav.missions import load_mission
from proxnav.storage.files import write_json
from proxnav.storage.run_record import run_record
from proxnav.targets.loading import load_target

_VALIDATION_SEED = 7_000_001
_MISSION = "observation-10-100m"


@dataclass(frozen=True)
class TrainCropOptions:
    """Trains the crop network on ray-cast crops that never repeat; resumes from --out."""

    out: Path
    """Folder of checkpoints, learning curve and weights."""
    target: str = "space-rider"
    """Name or file of the target."""
    side: int = 128
    """Pixels of the network's input: start small, finish large."""
    workers: int = 1
    """Processes that draw."""
    repeats: int = 4
    """Times that a drawn image is learnt from, each time as another view."""
    seed: int = 1
    """Of the scenes."""
    validation: int = 256
    """Crops that are kept aside."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    training: TrainHeatmapConfig = field(default_factory=TrainHeatmapConfig)


@dataclass(frozen=True)
class TrainFinderOptions:
    """Trains the finder on ray-cast frames that never repeat; resumes from --out."""

    out: Path
    """Folder of checkpoints, learning curve and weights."""
    target: str = "space-rider"
    """Name or file of the target."""
    side: int = 256
    """Pixels of the network's input."""
    workers: int = 1
    """Processes that draw."""
    repeats: int = 4
    """Times that a drawn image is learnt from, each time as another view."""
    seed: int = 2
    """Of the scenes."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    training: TrainFinderConfig = field(default_factory=TrainFinderConfig)


def crop(options: TrainCropOptions) -> None:
    """Entry of `proxnav train heatmap`."""
    _check_side(options.side)
    mission = replace(load_mission(_MISSION), target=options.target)
    crops = CropConfig(mission.training_mission, options.side, seed=options.seed)
    training = _for_target(options.training, options.target)
    if options.dry_run:
        print(dry_run(CropJob(crops), training, train_heatmap, options))
        return
    write_json(options.out / "config.json", run_record(options), indent=1)
    validate = _validation(replace(crops, seed=_VALIDATION_SEED, mission=mission), options.validation)
    source = sample_source(CropJob(crops), options.workers, options.repeats)
    result = train_heatmap(training, source, options.out, validate)
    print(f"{result.reason}: {result.samples} crops seen, best validation {result.best_score:.3f} px; {result.weights}")


def finder(options: TrainFinderOptions) -> None:
    """Entry of `proxnav train finder`."""
    _check_side(options.side)
    mission = replace(load_mission(_MISSION), target=options.target)
    frames = CropConfig(mission.training_mission, options.side, seed=options.seed)
    if options.dry_run:
        print(dry_run(WholeFrameJob(frames), options.training, train_finder, options))
        return
    write_json(options.out / "config.json", run_record(options), indent=1)
    source = sample_source(WholeFrameJob(frames), options.workers, options.repeats)
    result = train_finder(options.training, source, options.out)
    print(f"{result.reason}: {result.samples} frames seen; {result.weights}")


def dry_run(
    job: Callable,
    training: TrainHeatmapConfig | TrainFinderConfig,
    train: Callable,
    options: TrainCropOptions | TrainFinderOptions,
) -> str:
    """Drawing and learning, each measured on a few samples."""
    from proxnav.commands.dry_run import of_training

    loop = training.loop

    def learn(source: SampleSource, folder: Path, steps: int) -> None:
        train(replace(training, loop=replace(loop, steps=steps, log_every=1)), source, folder)

    estimate = of_training(job, learn, loop.steps, loop.batch_size, options.workers, options.repeats)
    return estimate.text(f"{loop.steps} steps of {loop.batch_size} samples")  # fmt: skip


def _check_side(side: int) -> None:
    if side < 32 or side % 32:
        raise InputError(f"--side {side}: the network needs a multiple of 32 px")


def _for_target(training: TrainHeatmapConfig, target: str) -> TrainHeatmapConfig:
    """As many maps as the target has keypoints."""
    return replace(training, net=replace(training.net, n_keypoints=len(load_target(target).keypoint_names)))


def _validation(crops: CropConfig, count: int) -> Callable[[nn.Module], float]:
    """Mean over the crops of the median keypoint error [px of the crop]; the crops are drawn once."""
    kept: list[TrainingSample] = []

    def validate(net: nn.Module) -> float:
        if not kept:
            make = CropJob(crops)()
            kept.extend(make(index) for index in range(count))
        return float(np.mean(np.nanmedian(keypoint_errors(net, kept), axis=1)))

    return validate
