"""Frames per second over workers, by the pool and by Ray, and what follows for a cluster."""

import os
import socket
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxnav.cluster.jobs import POOL, check_place, run_anywhere
from proxnav.cluster.local import run_in_processes
from proxnav.cluster.progress import Progress, silent
from proxnav.datasets.set.writer import DatasetWriter
from proxnav.errors import InputError
from proxnav.frames import FrameConfig, FrameJob
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import SceneSpec
from proxnav.rendered_set import EncodeJob, WriteJob
from proxnav.targets.loading import load_target

MILLION = 1_000_000
MACHINE = "counting"
"""What workers reach that share nothing but the machine."""
NODES, CORES = (1, 10, 100), 16
"""Nodes of the clusters that are predicted, and cores of each node."""
_WARM, _LEFT = 10, 2
"""Items for each worker before the clock starts, and left when it stops."""
_HANDED_OVER = 600
_MISSION = "observation-10-100m"

Rates = Mapping[str, Mapping[int, float]]
"""Items per second by place and number of workers."""


@dataclass(frozen=True)
class Series:
    """What is drawn while the clock runs."""

    frames: int
    """Frames on the clock."""
    size: int
    """Side of the image [px]."""
    drawn: FrameConfig


@dataclass(frozen=True)
class HandOverJob:
    """A job that does nothing but hand over as many bytes as a frame has: what Ray and the disk can take."""

    files: dict[str, int]

    def __call__(self) -> Callable[[int], dict[str, bytes]]:
        contents = {name: os.urandom(size) for name, size in self.files.items()}
        return lambda index: {f"images/{index}-{name}": content for name, content in contents.items()}


@dataclass(frozen=True)
class CountJob:
    """A job of plain arithmetic, without memory, files or messages: its efficiency is the machine's."""

    def __call__(self) -> Callable[[int], int]:
        return lambda index: sum(range(2_000_000))


@dataclass(frozen=True)
class _Signed:
    """A job whose results say who made them."""

    job: Any

    def __call__(self) -> Callable[[Any], tuple[str, Any]]:
        work, name = self.job(), f"{socket.gethostname()} {os.getpid()}"
        return lambda item: (name, work(item))


def measure_scale(
    workers: Sequence[int], places: Sequence[str], series: Series, progress: Progress = silent
) -> dict[str, Any]:
    """Rates of each number of workers in each place, and the hours of a million frames on clusters of `NODES`."""
    for place in places:
        check_place(place)
    if series.frames < 10 or not workers or min(workers) < 1 or not places:
        raise InputError("--frames must be at least 10, --workers at least 1 each, --on at least one place")
    rates: dict[str, dict[int, float]] = {place: {} for place in (MACHINE, *places)}
    with progress("runs", len(rates) * len(workers)) as done:
        for place, by_workers in rates.items():
            for count in workers:
                by_workers[count] = frames_per_s(count, place, series)
                done()
    return table(rates, frames_handed_over_per_s(places, series.size), NODES, CORES)


def frames_per_s(workers: int, on: str, series: Series) -> float:
    """Frames per second of `workers` together, written to the disk; the same frames whatever their number."""
    if on == MACHINE:
        counted = run_in_processes(_Signed(CountJob()), range(_WARM * workers + series.frames), workers)
        return rate(_signs(counted), workers, series.frames)
    scenes = draw_scenes(load_mission(_MISSION), series.frames + _WARM * workers, 0, series.size)
    scenes = scenes[series.frames :] + scenes[: series.frames]
    with tempfile.TemporaryDirectory() as folder:
        return rate(written(scenes, Path(folder), workers, on, series.drawn), workers, series.frames)


def written(scenes: Sequence[SceneSpec], folder: Path, workers: int, on: str, drawn: FrameConfig) -> Iterator[str]:
    """Who drew each frame, once it is on the disk: as `render` does it, which lets workers of the pool write."""
    writer = DatasetWriter(folder)
    frames = FrameJob(load_target(scenes[0].target), drawn)
    if on == POOL:
        yield from _signs(run_in_processes(_Signed(WriteJob(frames, writer)), scenes, workers))
        return
    for _, (name, files) in run_anywhere(_Signed(EncodeJob(frames)), scenes, workers, on):
        writer.put(files)
        yield name


def _signs(results: Iterable[tuple[Any, tuple[str, Any]]]) -> Iterator[str]:
    return (name for _, (name, _) in results)


def rate(names: Iterable[str], workers: int, count: int) -> float:
    """Results per second, by who made each: all `workers` are warm when the clock starts and busy when it stops.

    InputError where one of them was not ready before all was done.
    """
    given: Counter[str] = Counter()
    start, first, now, last = None, 0, 0.0, _WARM * workers + count - _LEFT * workers
    for number, name in enumerate(names, 1):
        given[name] += 1
        now = time.perf_counter() if number <= last else now
        if start is None and number >= _WARM * workers and len(given) >= workers and min(given.values()) >= _LEFT:
            start, first = now, number
    if start is None or first >= last:
        raise InputError(f"{len(given)} of {workers} workers were at work in time; give more --frames")
    return (last - first) / (now - start)


def frames_handed_over_per_s(places: Sequence[str], size: int) -> float:
    """What one driver can take from Ray and write, in frames of `size` px a side."""
    (scene,) = draw_scenes(load_mission(_MISSION), 1, 0, size)
    make = EncodeJob(FrameJob(scene.target, FrameConfig("raycast")))()
    sizes = {str(k): len(content) for k, content in enumerate(make(scene).values())}
    place = next((on for on in places if on != POOL), POOL)
    with tempfile.TemporaryDirectory() as folder:
        writer = DatasetWriter(Path(folder))

        def handed_over() -> Iterator[str]:
            items = range(2 * _WARM + _HANDED_OVER)
            for _, (name, files) in run_anywhere(_Signed(HandOverJob(sizes)), items, 2, place):
                writer.put(files)
                yield name

        return rate(handed_over(), 2, _HANDED_OVER)


def table(rates: Rates, hand_over: float, nodes: Sequence[int], cores: int) -> dict[str, Any]:
    """Rates, efficiencies, and hours for a million frames: N nodes of C cores draw N C r e frames a second.

    r is one worker's rate in the last place, e the efficiency of the most workers there; the driver's hand-over is the
    ceiling.
    """
    rows = [
        {"on": place, "workers": count, "frames_per_s": value, "efficiency": value / (count * by[min(by)] / min(by))}
        for place, by in rates.items()
        for count, value in by.items()
    ]
    last = [*rates.values()][-1]
    one, efficiency = last[min(last)] / min(last), rows[-1]["efficiency"]
    predicted = []
    for count in nodes:
        drawn = count * cores * one * min(efficiency, 1.0)
        hours = MILLION / min(drawn, hand_over) / 3600.0
        limit = "the driver" if drawn > hand_over else "the nodes"
        predicted.append({"nodes": count, "cores_each": cores, "hours": hours, "limit": limit})
    return {"rates": rows, "hand_over_frames_per_s": hand_over, "a_million_frames": predicted}


def text(found: dict[str, Any]) -> str:
    """The table for people."""
    lines = [f"{'on':>8}  {'workers':>7}  {'per s':>8}  {'efficiency':>10}"]
    lines += [
        f"{r['on'][:8]:>8}  {r['workers']:>7}  {r['frames_per_s']:>8.2f}  {r['efficiency']:>10.2f}"
        for r in found["rates"]
    ]
    lines.append(f"\none driver takes and writes {found['hand_over_frames_per_s']:.0f} frames/s; a million frames:")
    lines += [
        f"{p['nodes']:>4} nodes of {p['cores_each']} cores: {p['hours']:.1f} h, limited by {p['limit']}"
        for p in found["a_million_frames"]
    ]
    return "\n".join(lines)
