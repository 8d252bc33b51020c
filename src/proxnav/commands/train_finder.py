"""`proxnav train finder`: the network that finds the target in the full frame, on frames drawn while it learns."""

from dataclasses import dataclass, field

from proxnav.cli.options import DrawnTrainingOptions
from proxnav.detection.heatmap.config import TrainFinderConfig


@dataclass(frozen=True)
class TrainFinderOptions(DrawnTrainingOptions):
    """Trains the finder on ray-cast frames that never repeat; resumes from --out."""

    side: int = 256
    """Pixels of the network's input."""
    seed: int = 2
    """Seed of the scenes."""
    training: TrainFinderConfig = field(default_factory=TrainFinderConfig)


def run(options: TrainFinderOptions) -> None:
    """Trains the finder, or says what it would take."""
    from proxnav.learning.dry_run import training_dry_run
    from proxnav.learning.heatmap_training import finder_training

    training = finder_training(
        options.training, options.read_mission(), options.side, options.seed, options.workers, options.repeats
    )
    if options.dry_run:
        print(training_dry_run(training))
        return
    result = training.run(options.out, options)
    print(f"{result.reason}: {result.samples} frames seen; {result.weights}")
