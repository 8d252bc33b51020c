"""`proxnav benchmark speedplus`: a model on the images of SPEED+, with the scores of its challenges."""

from dataclasses import dataclass
from pathlib import Path

from proxnav.cli.options import CameraOptions, ModelOptions, ResultOptions, WorkerOptions


@dataclass(frozen=True, kw_only=True)
class SpeedplusConfig(ModelOptions, CameraOptions, WorkerOptions, ResultOptions):
    """Estimates every image of each domain that the folder holds, and compares with the published truth."""

    root: Path
    """Folder of SPEED+, with lightbox, sunlamp or synthetic in it, or one such folder: images and labels beside."""
    model: str = "tango"
    """Name of a shipped model, or a folder with a model.json."""
    limit: int = 0
    """Images of each domain at most, evenly over it; 0 takes all."""


def run(config: SpeedplusConfig) -> None:
    """Measures and gives the tables."""
    from proxnav.benchmarks.speedplus import Source, measure_speedplus, table
    from proxnav.cli.progress import progress, say_when_compiling

    say_when_compiling("pose")
    source = Source(config.root, config.model, config.limit, config.camera_or)
    found = measure_speedplus(source, config.backend, config.workers, config.on, progress)
    config.give(found, "speedplus", table)
