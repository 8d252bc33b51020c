"""`proxnav benchmark render`: labelled images per second of both renderers, in one run."""

from dataclasses import dataclass

from proxnav.cli.options import ResultOptions


@dataclass(frozen=True)
class RenderBenchmarkConfig(ResultOptions):
    """Draws the same scenes with each renderer at each size, one process, full label set and PNG included.

    Every frame shows Earth: it costs both renderers the same and so holds the ratio down.
    The ratio of the rates is what counts; the rates themselves belong to this machine and its load.
    """

    frames: int = 12
    """Frames of each renderer and size, after two that are not counted."""
    sizes: tuple[int, ...] = (512, 1024)
    """Sides of the image [px]."""
    samples: int = 32
    """Cycles: samples per pixel."""
    seed: int = 0


def run(config: RenderBenchmarkConfig) -> None:
    """Measures and gives the table."""
    from proxnav.benchmarks.render import measure_rendering, table
    from proxnav.cli.progress import progress
    from proxnav.storage.run_record import run_record

    rows = measure_rendering(config.sizes, config.frames, config.samples, config.seed, progress)
    config.give({"images_per_s": rows, "record": run_record(config)}, "render", table)
