"""`--dry-run` of the long jobs: a little of the job is done in a temporary folder, timed, and scaled up."""

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from proxnav.detection.samples import SampleSource, TrainingSample
from proxnav.frames import FrameConfig
from proxnav.records import SceneSpec
from proxnav.rendered_set import render

_FRAMES = 3
_DRAWN = 8


@dataclass(frozen=True, slots=True)
class Estimate:
    """What a job would take on this machine, as loaded as it is now."""

    seconds: float
    size_bytes: float

    def __add__(self, other: "Estimate") -> "Estimate":
        return Estimate(self.seconds + other.seconds, self.size_bytes + other.size_bytes)

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
    """In kB, MB or GB.

    >>> size(2.5e6), size(3e9)
    ('2.5 MB', '3.0 GB')
    """
    units = ((1e9, "GB"), (1e6, "MB"), (1e3, "kB"))
    value, unit = next((size_bytes / f, name) for f, name in units if size_bytes >= f or name == "kB")
    return f"{value:.1f} {unit}" if value < 9.5 else f"{value:.0f} {unit}"


def of_rendering(scenes: Sequence[SceneSpec], config: FrameConfig, workers: int) -> Estimate:
    """Three frames are rendered and written; the first one starts the renderer and is counted once."""
    few, times = list(scenes[:_FRAMES]), [time.perf_counter()]
    with TemporaryDirectory() as folder:
        render(few, config, Path(folder) / "set", 1, lambda: times.append(time.perf_counter()))
        written = folder_bytes(Path(folder)) / len(few)
    first = times[1] - times[0]
    each = (times[-1] - times[1]) / (len(few) - 1) if len(few) > 1 else first
    lanes = min(workers, os.cpu_count() or 1) if config.renderer == "raycast" else 1
    return Estimate(first + each * (len(scenes) - 1) / lanes, written * len(scenes))


def of_training(
    job: Callable[[], Callable[[int], TrainingSample]],
    learn: Callable[[SampleSource, Path, int], object],
    steps: int,
    batch: int,
    workers: int,
    repeats: int,
) -> Estimate:
    """Eight samples are drawn, and learnt from in 2 and then 6 steps; drawing and learning share the cores.

    `learn(source, folder, steps)` trains into a folder, resuming where it stopped.
    """
    make = job()
    make(0)
    start = time.perf_counter()
    drawn = [make(index) for index in range(1, 1 + _DRAWN)]
    draw_s = (time.perf_counter() - start) / len(drawn)
    with TemporaryDirectory() as folder:
        walls = []
        for count in (2, 6):
            start = time.perf_counter()
            learn(lambda begin, stride: cycle(drawn), Path(folder), count)
            walls.append(time.perf_counter() - start)
        written = folder_bytes(Path(folder))
    learn_s = max(walls[1] - walls[0], 0.2 * walls[1]) / (2 * batch)
    drawing, cores = draw_s / repeats, os.cpu_count() or 1
    each = max(learn_s, drawing / workers) if cores > workers else (learn_s * cores + drawing) / cores
    return Estimate(walls[0] + each * steps * batch, written)


def seconds_each(work: Callable[[Any], object], items: Sequence[Any]) -> float:
    """Of up to three items after one that is not counted, since it may compile; of that one where it is alone."""
    times = [time.perf_counter()]
    for item in items[: 1 + _FRAMES]:
        work(item)
        times.append(time.perf_counter())
    return (times[-1] - times[1]) / (len(times) - 2) if len(times) > 2 else times[1] - times[0]


def of_runs(make: Callable[[Path], object], count: float, workers: int) -> Estimate:
    """As many runs as `count`, of which `make` does one into a folder: twice, since the first one compiles."""
    with TemporaryDirectory() as folder:
        times = [time.perf_counter()]
        for name in ("first", "second"):
            (Path(folder) / name).mkdir()
            make(Path(folder) / name)
            times.append(time.perf_counter())
        written = folder_bytes(Path(folder) / "second")
    lanes = max(1, min(workers, os.cpu_count() or 1))
    return Estimate((times[2] - times[1]) * count / lanes, written * count)


def folder_bytes(folder: Path) -> int:
    """Of all files below."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
