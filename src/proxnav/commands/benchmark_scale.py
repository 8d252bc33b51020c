"""`proxnav benchmark scale`: frames per second over workers, by the pool and by Ray, and what follows for a cluster."""

from dataclasses import dataclass

from proxnav.cli.options import ResultOptions
from proxnav.cluster.jobs import POOL
from proxnav.rendering.config import FrameConfig, Renderer


@dataclass(frozen=True)
class ScaleBenchmarkConfig(ResultOptions):
    """Draws and writes the same frames with each number of workers, in each place, and lets them only count as well.

    The clock runs while every worker is busy: not while they start, not when the last of them are left.
    """

    workers: tuple[int, ...] = (1, 2)
    on: tuple[str, ...] = (POOL, "ray")
    """pool, ray or ray://host:port."""
    frames: int = 200
    """Frames on the clock."""
    renderer: Renderer = "raycast"
    samples: int = 32
    """Cycles: samples per pixel."""
    size: int = 256
    """Side of the image [px]."""


def run(config: ScaleBenchmarkConfig) -> None:
    """Measures and gives the table."""
    from proxnav.benchmarks.scale import Series, measure_scale, text
    from proxnav.cli.progress import progress
    from proxnav.storage.run_record import run_record

    series = Series(config.frames, config.size, FrameConfig(config.renderer, config.samples, 1))
    found = measure_scale(config.workers, config.on, series, progress)
    config.give(found | {"record": run_record(config)}, "scale", text)
