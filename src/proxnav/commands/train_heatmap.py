"""`proxnav train heatmap`: the crop network; every image is drawn fresh while it learns."""

from dataclasses import dataclass, field

from proxnav.cli.options import DrawnTrainingOptions
from proxnav.detection.heatmap.config import TrainHeatmapConfig


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


def run(options: TrainCropOptions) -> None:
    """Trains the crop network, or says what it would take."""
    from proxnav.learning.dry_run import training_dry_run
    from proxnav.learning.heatmap_training import crop_training

    training = crop_training(
        options.training, options.read_mission(), options.side, options.seed, options.workers, options.repeats,
        options.validation,
    )  # fmt: skip
    if options.dry_run:
        print(training_dry_run(training))
        return
    result = training.run(options.out, options)
    print(f"{result.reason}: {result.samples} crops seen, best validation {result.best_score:.3f} px; {result.weights}")
