"""`proxnav benchmark detector`: how long the detector's errors last, measured on frames along the spiral."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from proxnav.benchmarks.detector_errors import Instants, measure_detector
from proxnav.cli.options import WorkerOptions
from proxnav.cli.progress import progress


@dataclass(frozen=True)
class DetectorBenchmarkConfig(WorkerOptions):
    """Renders the sunlit spiral 10-100 m, splits the errors of keypoints and poses by how long they last."""

    out: Path
    """Folder: errors.jsonl, a line a frame, from which an interrupted run goes on; detector.json at the end."""
    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    step_s: float = 8.0
    """Time between frames."""
    burst_every_s: float = 400.0
    """Time between bursts."""
    burst: int = 12
    """Frames of a burst, one a second."""
    max_phase_deg: float = 90.0
    """Largest angle Sun-target-camera."""


def run(config: DetectorBenchmarkConfig) -> None:
    """Entry of `proxnav benchmark detector`."""
    instants = Instants(config.step_s, config.burst_every_s, config.burst, float(np.deg2rad(config.max_phase_deg)))
    print(
        json.dumps(measure_detector(config.out, config.model, instants, config.workers, config.on, progress), indent=1)
    )
