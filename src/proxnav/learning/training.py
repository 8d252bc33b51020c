"""A training that is ready to begin: what draws its samples, what learns from them, and for how long."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from proxnav.detection.samples import SampleSource, TrainingSample
from proxnav.detection.training.config import LoopConfig
from proxnav.detection.training.learner import TrainingResult, Validate
from proxnav.storage.files import write_json
from proxnav.storage.run_record import run_record


class Learn(Protocol):
    """Trains into a folder, from where it stopped there."""

    def __call__(
        self, loop: LoopConfig, source: SampleSource, out: Path, validate: Validate | None
    ) -> TrainingResult: ...


@dataclass(frozen=True, slots=True)
class Training:
    """One network, its samples and its loop."""

    learn: Learn
    loop: LoopConfig
    draw: Callable[[], Callable[[int], TrainingSample]]
    """Builds the function from a sample's number to the sample."""
    source: SampleSource
    """The stream of these samples, drawn ahead by workers or read from a data set."""
    validate: Validate | None
    workers: int
    """Processes that draw."""
    repeats: int
    """Times that a drawn image is learnt from."""

    def run(self, out: Path, options: Any) -> TrainingResult:
        """Trains into `out`; `options` is the dataclass that the run was asked with, which config.json keeps."""
        write_json(out / "config.json", run_record(options), indent=1)
        return self.learn(self.loop, self.source, out, self.validate)
