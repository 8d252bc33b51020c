"""`proxnav benchmark track`: the tracker without a network, with skipped frames and starts that are off."""

from dataclasses import dataclass
from pathlib import Path

from proxnav.benchmarks.tracking_flights import Motion
from proxnav.cli.options import ResultOptions


@dataclass(frozen=True, kw_only=True)
class TrackBenchmarkConfig(ResultOptions):
    """Ray-casts the spiral and a tumble of each target, and follows the target through them."""

    targets: tuple[str, ...] = ("space-rider",)
    """Names or files of targets; each is seen from ranges in proportion to its size."""
    motions: tuple[Motion, ...] = ("spiral", "tumble")
    """Which sequences."""
    frames: int = 150
    """Frames of each sequence: 3 deg a frame in the tumble, 10 s a frame in the spiral at 150."""
    size: int = 384
    """Side of the images [px]."""
    every: tuple[int, ...] = (1, 2, 3, 4)
    """Take every n-th frame."""
    start_errors_deg: tuple[float, ...] = (2.0, 5.0, 10.0, 20.0)
    """How far the first attitude is off."""
    starts: int = 12
    """Starts for each of these errors."""
    start_frames: int = 8
    """Frames that each start runs."""
    seed: int = 7
    images: Path = Path("out/track")
    """Folder of the frames; those that are there are not drawn again."""


def run(config: TrackBenchmarkConfig) -> None:
    """Measures and gives the table."""
    from proxnav.benchmarks.tracking import TrackPlan, measure_tracking, table
    from proxnav.cli.progress import progress

    plan = TrackPlan(
        config.frames, config.size, config.every, config.start_errors_deg, config.starts, config.start_frames,
        config.seed,
    )  # fmt: skip
    config.give(measure_tracking(config.targets, config.motions, plan, config.images, progress), "tracking", table)
