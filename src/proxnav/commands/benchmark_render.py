"""`proxnav benchmark render`: labelled images per second of both renderers, in one run."""

import json
import tempfile
import time
from dataclasses import dataclass, replace
from pathlib import Path

from proxnav.cli.progress import progress
from proxnav.datasets.set.writer import DatasetWriter
from proxnav.errors import InputError
from proxnav.frames import FrameConfig, FrameJob, Renderer
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import SceneSpec
from proxnav.storage.files import write_json
from proxnav.storage.run_record import run_record
from proxnav.targets.loading import load_target


@dataclass(frozen=True)
class RenderBenchmarkConfig:
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
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    json: bool = False
    """Print JSON instead of a table."""
    out: Path | None = None
    """Folder for render.json."""


def run(config: RenderBenchmarkConfig) -> None:
    """Entry of `proxnav benchmark render`."""
    if config.frames < 1 or not config.sizes:
        raise InputError("--frames must be at least 1 and --sizes name at least one side")
    if config.dry_run:
        print(dry_run(config))
        return
    rows = []
    with progress("frames", 2 * len(config.sizes)) as done:
        for size in config.sizes:
            rates = {}
            for renderer in ("raycast", "cycles"):
                rates[renderer] = _rate(renderer, size, config)
                done()
            rows.append({"size_px": size, **rates, "ratio": rates["raycast"] / rates["cycles"]})
    found = {"images_per_s": rows, "record": run_record(config)}
    if config.out is not None:
        write_json(config.out / "render.json", found, indent=1)
    print(json.dumps(found, indent=1) if config.json else _table(rows, config.samples))


def _rate(renderer: Renderer, size: int, config: RenderBenchmarkConfig) -> float:
    """Labelled images per second, written as PNG."""
    mission = load_mission("observation-10-100m")
    in_view = replace(mission, looks=replace(mission.looks, earth=1.0))
    scenes = draw_scenes(in_view, config.frames + 2, config.seed, size)
    make = FrameJob(mission.target, FrameConfig(renderer, config.samples))()
    with tempfile.TemporaryDirectory() as folder:
        writer = DatasetWriter(Path(folder) / "set")
        writer.begin(scenes, load_target(mission.target))

        def draw(scene: SceneSpec) -> None:
            frame = make(scene)
            writer.add(scene, frame.image, frame.mask, frame.label)

        for scene in scenes[:2]:
            draw(scene)
        start = time.perf_counter()
        for scene in scenes[2:]:
            draw(scene)
        return config.frames / (time.perf_counter() - start)


def dry_run(config: RenderBenchmarkConfig) -> str:
    """Each renderer at each size, measured on three frames."""
    from proxnav.commands.dry_run import Estimate, of_rendering

    total, mission = Estimate(0.0, 0.0), load_mission("observation-10-100m")
    for size in config.sizes:
        scenes = draw_scenes(mission, config.frames + 2, config.seed, size)
        for renderer in ("raycast", "cycles"):
            total += of_rendering(scenes, FrameConfig(renderer, config.samples), 1)
    return Estimate(total.seconds, 2e3).text(f"{2 * len(config.sizes)} series of {config.frames} frames")


def _table(rows: list[dict[str, float]], samples: int) -> str:
    lines = [f"{'size [px]':>9}  {'raycast [1/s]':>13}  {f'Cycles, {samples} samples [1/s]':>26}  {'ratio':>6}"]
    lines += [f"{r['size_px']:>9}  {r['raycast']:>13.2f}  {r['cycles']:>26.3f}  {r['ratio']:>6.1f}" for r in rows]
    return "\n".join(lines)
