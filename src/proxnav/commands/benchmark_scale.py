"""`proxnav benchmark scale`: frames per second over workers, by the pool and by Ray, and what follows for a cluster."""

import json
import os
import socket
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxnav.cli.progress import progress
from proxnav.cluster.jobs import POOL, check_place, run_anywhere
from proxnav.cluster.local import run_in_processes
from proxnav.datasets.set.writer import DatasetWriter
from proxnav.errors import InputError
from proxnav.frames import FrameConfig, FrameJob, Renderer
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import SceneSpec
from proxnav.rendered_set import EncodeJob, WriteJob
from proxnav.storage.files import write_json
from proxnav.storage.run_record import run_record
from proxnav.targets.loading import load_target

MILLION = 1_000_000
MACHINE = "counting"
"""What workers reach that share nothing but the machine."""
_WARM, _LEFT = 10, 2
"""Items for each worker before the clock starts, and left when it stops."""


@dataclass(frozen=True)
class ScaleBenchmarkConfig:
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
    nodes: tuple[int, ...] = (1, 10, 100)
    """Of the prediction."""
    cores: int = 16
    """Of each node in the prediction."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    json: bool = False
    """Print JSON only."""
    out: Path | None = None
    """Folder for scale.json."""


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


def run(config: ScaleBenchmarkConfig) -> None:
    """Entry of `proxnav benchmark scale`."""
    for place in config.on:
        check_place(place)
    if config.frames < 10 or not config.workers or min(config.workers) < 1 or not config.on:
        raise InputError("--frames must be at least 10, --workers at least 1 each, --on at least one place")
    if config.dry_run:
        print(dry_run(config))
        return
    places = (MACHINE, *config.on)
    rates: dict[str, dict[int, float]] = {place: {} for place in places}
    with progress("runs", len(places) * len(config.workers)) as done:
        for place in places:
            for count in config.workers:
                rates[place][count] = frames_per_s(count, place, config)
                done()
    found = table(rates, frames_handed_over_per_s(config), config) | {"record": run_record(config)}
    if config.out is not None:
        write_json(config.out / "scale.json", found, indent=1)
    print(json.dumps(found, indent=1) if config.json else text(found))


def dry_run(config: ScaleBenchmarkConfig) -> str:
    """Measured on three frames; workers and Ray take about 10 s to begin, and as long to count."""
    from proxnav.commands.dry_run import Estimate, seconds_each

    scenes = draw_scenes(load_mission("observation-10-100m"), 4, 0, config.size)
    job = EncodeJob(FrameJob(scenes[0].target, FrameConfig(config.renderer, config.samples, 1)))()
    each, seconds, cores = seconds_each(job, scenes), 0.0, os.cpu_count() or 1
    for count in config.workers:
        frames = config.frames + _WARM * count
        seconds += len(config.on) * (each * frames / min(count, cores) + 10.0) + 20.0
    kept = sum(map(len, job(scenes[0]).values())) * (config.frames + _WARM * max(config.workers))
    return Estimate(seconds, kept).text(f"{len(config.on) * len(config.workers)} series of {config.frames} frames")


def frames_per_s(workers: int, on: str, config: ScaleBenchmarkConfig) -> float:
    """Of `workers` together, written to the disk; the same frames whatever their number."""
    if on == MACHINE:
        return rate(_signs(run_in_processes(_Signed(CountJob()), range(_WARM * workers + config.frames), workers)),
                    workers, config.frames)  # fmt: skip
    mission = load_mission("observation-10-100m")
    scenes = draw_scenes(mission, config.frames + _WARM * workers, 0, config.size)
    scenes = scenes[config.frames :] + scenes[: config.frames]
    with tempfile.TemporaryDirectory() as folder:
        return rate(written(scenes, Path(folder), workers, on, config), workers, config.frames)


def written(
    scenes: Sequence[SceneSpec], folder: Path, workers: int, on: str, config: ScaleBenchmarkConfig
) -> Iterator[str]:
    """Who drew each frame, once it is on the disk: as `render` does it, which lets workers of the pool write."""
    writer = DatasetWriter(folder)
    frames = FrameJob(load_target(scenes[0].target), FrameConfig(config.renderer, config.samples, 1))
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


def frames_handed_over_per_s(config: ScaleBenchmarkConfig) -> float:
    """What one driver can take from Ray and write, in frames of this size."""
    mission = load_mission("observation-10-100m")
    scene: SceneSpec = draw_scenes(mission, 1, 0, config.size)[0]
    make = EncodeJob(FrameJob(mission.target, FrameConfig("raycast")))()
    sizes = {str(k): len(content) for k, content in enumerate(make(scene).values())}
    place = next((on for on in config.on if on != POOL), POOL)
    with tempfile.TemporaryDirectory() as folder:
        writer = DatasetWriter(Path(folder))

        def handed_over() -> Iterator[str]:
            for _, (name, files) in run_anywhere(_Signed(HandOverJob(sizes)), range(2 * _WARM + 600), 2, place):
                writer.put(files)
                yield name

        return rate(handed_over(), 2, 600)


def table(rates: dict[str, dict[int, float]], hand_over: float, config: ScaleBenchmarkConfig) -> dict[str, Any]:
    """Rates, efficiencies, and hours for a million frames: N nodes of C cores draw N C r e frames a second.

    r is one worker's rate, e the efficiency of the most workers measured; the driver's hand-over is the ceiling.
    """
    rows = [
        {"on": place, "workers": count, "frames_per_s": value, "efficiency": value / (count * by[min(by)] / min(by))}
        for place, by in rates.items()
        for count, value in by.items()
    ]
    last = rates[config.on[-1]]
    one, efficiency = last[min(last)] / min(last), rows[-1]["efficiency"]
    predicted = []
    for nodes in config.nodes:
        drawn = nodes * config.cores * one * min(efficiency, 1.0)
        hours = MILLION / min(drawn, hand_over) / 3600.0
        limit = "the driver" if drawn > hand_over else "the nodes"
        predicted.append({"nodes": nodes, "cores_each": config.cores, "hours": hours, "limit": limit})
    return {"rates": rows, "hand_over_frames_per_s": hand_over, "a_million_frames": predicted}


def text(found: dict[str, Any]) -> str:
    """For people."""
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
