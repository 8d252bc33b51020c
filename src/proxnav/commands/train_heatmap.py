"""`proxnav train heatmap`: the crop network; every image is drawn fresh while it learns."""

from dataclasses import dataclass, field
from pathlib import Path

from proxnav.detection.heatmap.config import TrainHeatmapConfig


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
    """Seed of the scenes."""
    validation: int = 256
    """Crops that are kept aside."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    training: TrainHeatmapConfig = field(default_factory=TrainHeatmapConfig)


def run(options: TrainCropOptions) -> None:
    """Trains the crop network, or says what it would take."""
    from proxnav.learning.dry_run import training_dry_run
    from proxnav.learning.heatmap_training import crop_training

    training = crop_training(
        options.training, options.target, options.side, options.seed, options.workers, options.repeats,
        options.validation,
    )  # fmt: skip
    if options.dry_run:
        print(training_dry_run(training))
        return
    result = training.run(options.out, options)
    print(f"{result.reason}: {result.samples} crops seen, best validation {result.best_score:.3f} px; {result.weights}")
