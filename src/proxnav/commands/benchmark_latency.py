"""`proxnav benchmark latency`: image to pose and covariance, frame by frame, beside torchvision's Keypoint R-CNN."""

from dataclasses import dataclass

from proxnav.cli.options import MissionOptions, ResultOptions
from proxnav.detection.sessions import Backend


@dataclass(frozen=True)
class LatencyConfig(MissionOptions, ResultOptions):
    """Frames of the mission, ray-cast, estimated by each model and by the reference in turn."""

    models: tuple[str, ...] = ("space-rider-fast", "space-rider")
    """Names or folders."""
    frames: int = 20
    seed: int = 300
    backend: Backend = "auto"
    threads: int = 0
    """Threads of every runtime; 0 takes all cores."""
    reference_frames: int = 5
    """Frames of the reference, which takes seconds for each. 0 leaves it out."""


def run(config: LatencyConfig) -> None:
    """Measures and gives the table."""
    from proxnav.benchmarks.latency import measure_latency, table
    from proxnav.cli.progress import progress

    found = measure_latency(
        config.models, config.read_mission(), config.frames, config.reference_frames, config.seed,
        config.backend, config.threads, progress,
    )  # fmt: skip
    config.give(found, "latency", table)
