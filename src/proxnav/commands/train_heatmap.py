"""`proxnav train heatmap` and `proxnav train finder`: every image is drawn fresh while the network learns."""

from dataclasses import dataclass, field
from pathlib import Path

from proxnav.cli.options import DryRunOptions
from proxnav.detection.heatmap.train import TrainFinderConfig, TrainHeatmapConfig
from proxnav.learning.dry_run import training_dry_run
from proxnav.learning.heatmap_training import crop_training, finder_training


@dataclass(frozen=True, kw_only=True)
class DrawnTrainingOptions(DryRunOptions):
    """What both networks are asked: images that never repeat, of a target, into a folder."""

    out: Path
    """Folder of checkpoints, learning curve and weights."""
    target: str = "space-rider"
    """Name or file of the target."""
    workers: int = 1
    """Processes that draw."""
    repeats: int = 4
    """Times that a drawn image is learnt from, each time as another view."""


@dataclass(frozen=True)
class TrainCropOptions(DrawnTrainingOptions):
    """Trains the crop network on ray-cast crops that never repeat; resumes from --out."""

    side: int = 128
    """Pixels of the network's input: start small, finish large."""
    seed: int = 1
    """Seed of the scenes."""
    validation: int = 256
    """Crops that are kept aside."""
    training: TrainHeatmapConfig = field(default_factory=TrainHeatmapConfig)


@dataclass(frozen=True)
class TrainFinderOptions(DrawnTrainingOptions):
    """Trains the finder on ray-cast frames that never repeat; resumes from --out."""

    side: int = 256
    """Pixels of the network's input."""
    seed: int = 2
    """Seed of the scenes."""
    training: TrainFinderConfig = field(default_factory=TrainFinderConfig)


def crop(options: TrainCropOptions) -> None:
    """Entry of `proxnav train heatmap`."""
    training = crop_training(
        options.training, options.target, options.side, options.seed, options.workers, options.repeats,
        options.validation,
    )  # fmt: skip
    if options.dry_run:
        print(training_dry_run(training))
        return
    result = training.run(options.out, options)
    print(f"{result.reason}: {result.samples} crops seen, best validation {result.best_score:.3f} px; {result.weights}")


def finder(options: TrainFinderOptions) -> None:
    """Entry of `proxnav train finder`."""
    training = finder_training(
        options.training, options.target, options.side, options.seed, options.workers, options.repeats
    )
    if options.dry_run:
        print(training_dry_run(training))
        return
    result = training.run(options.out, options)
    print(f"{result.reason}: {result.samples} frames seen; {result.weights}")
