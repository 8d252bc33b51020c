"""`proxnav benchmark detector`: how long the detector's errors last, measured on frames along the spiral."""

import json
from dataclasses import dataclass
from pathlib import Path

from proxnav.cli.options import WorkerOptions


@dataclass(frozen=True)
class DetectorBenchmarkConfig(WorkerOptions):
    """Renders the sunlit spiral 10-100 m, splits the errors of keypoints and poses by how long they last."""

    out: Path
    """Folder: errors.jsonl, a line a frame, from which an interrupted run goes on; detector.json at the end."""
    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    step_s: float = 8.0
    """Time between frames."""


def run(config: DetectorBenchmarkConfig) -> None:
    """Measures and prints how long errors last."""
    from proxnav.benchmarks.detector_errors import measure_detector
    from proxnav.cli.progress import progress

    print(
        json.dumps(
            measure_detector(config.out, config.model, config.step_s, config.workers, config.on, progress), indent=1
        )
    )
