"""`proxnav train finder`: the network that finds the target in the full frame, on frames drawn while it learns."""

from dataclasses import dataclass, field
from pathlib import Path

from proxnav.detection.heatmap.config import TrainFinderConfig


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
    """Seed of the scenes."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    training: TrainFinderConfig = field(default_factory=TrainFinderConfig)


def run(options: TrainFinderOptions) -> None:
    """Trains the finder, or says what it would take."""
    from proxnav.learning.dry_run import training_dry_run
    from proxnav.learning.heatmap_training import finder_training

    training = finder_training(
        options.training, options.target, options.side, options.seed, options.workers, options.repeats
    )
    if options.dry_run:
        print(training_dry_run(training))
        return
    result = training.run(options.out, options)
    print(f"{result.reason}: {result.samples} frames seen; {result.weights}")
