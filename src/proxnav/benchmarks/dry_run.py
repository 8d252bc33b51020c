"""`--dry-run` of the long jobs: a little of the job is done in a temporary folder, timed, and scaled up."""

import os
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import cycle
from pathlib import Path
from tempfile import TemporaryDirectory

from proxnav.frames import FrameConfig
from proxnav.learning.training import Training
from proxnav.records import SceneSpec
from proxnav.rendered_set import render

_FRAMES = 3
_DRAWN = 8


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a job would take on this machine, as loaded as it is now."""

    seconds: float
    size_bytes: float

    def text(self, job: str) -> str:
        """One line for people."""
        return f"dry run: {job} would take about {duration(self.seconds)} and {size(self.size_bytes)} of disk here"


def duration(seconds: float) -> str:
    """Two digits in a unit that people use.

    >>> duration(42.0), duration(1500.0), duration(90_000.0)
    ('42 s', '25 min', '25 h')
    """
    value, unit = (seconds, "s") if seconds < 100 else (seconds / 60, "min")
    value, unit = (value, unit) if seconds < 7200 else (seconds / 3600, "h")
    return f"{value:.1f} {unit}" if value < 9.5 else f"{value:.0f} {unit}"


def size(size_bytes: float) -> str:
    """Bytes as kB, MB or GB.

    >>> size(2.5e6), size(3e9)
    ('2.5 MB', '3.0 GB')
    """
    units = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"))
    value, unit = next((size_bytes / f, name) for f, name in units if size_bytes >= f or name == "kB")
    return f"{value:.1f} {unit}" if value < 9.5 else f"{value:.0f} {unit}"


def rendering_dry_run(scenes: Sequence[SceneSpec], config: FrameConfig, workers: int) -> str:
    """What rendering would take: three frames are rendered and written; the first starts the renderer, once."""
    few, times = list(scenes[:_FRAMES]), [time.perf_counter()]
    with TemporaryDirectory() as folder:
        render(few, config, Path(folder) / "set", 1, lambda: times.append(time.perf_counter()))
        written = folder_bytes(Path(folder)) / len(few)
    first = times[1] - times[0]
    each = (times[-1] - times[1]) / (len(few) - 1) if len(few) > 1 else first
    lanes = min(workers, os.cpu_count() or 1) if config.renderer == "raycast" else 1
    return Estimate(first + each * (len(scenes) - 1) / lanes, written * len(scenes)).text(f"{len(scenes)} frames")


def training_dry_run(training: Training) -> str:
    """What training would take: eight samples are drawn, and learnt from in 2 and then 6 steps.

    Drawing and learning share the cores.
    """
    loop = training.loop
    batch = loop.batch_size * loop.accumulate
    make = training.draw()
    make(0)
    start = time.perf_counter()
    drawn = [make(index) for index in range(1, 1 + _DRAWN)]
    drawing = (time.perf_counter() - start) / len(drawn) / training.repeats
    with TemporaryDirectory() as folder:
        walls = []
        for steps in (2, 6):
            start = time.perf_counter()
            training.learn(replace(loop, steps=steps), lambda begin, stride: cycle(drawn), Path(folder), None)
            walls.append(time.perf_counter() - start)
        written = folder_bytes(Path(folder))
    learning, cores = max(walls[1] - walls[0], 0.2 * walls[1]) / (2 * batch), os.cpu_count() or 1
    if cores > training.workers:
        each = max(learning, drawing / training.workers)
    else:
        each = (learning * cores + drawing) / cores
    return Estimate(walls[0] + each * loop.steps * batch, written).text(f"{loop.steps} steps of {batch} samples")


def folder_bytes(folder: Path) -> int:
    """Bytes of all files below a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
