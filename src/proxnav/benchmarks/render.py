"""Labelled images per second of both renderers."""

import tempfile
import time
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from proxnav.cluster.progress import Progress, silent
from proxnav.datasets.set.writer import DatasetWriter
from proxnav.errors import InputError
from proxnav.frames import FrameConfig, FrameJob
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.targets.loading import load_target

_WARM = 2
"""Frames of each series that are not counted."""


def measure_rendering(
    sizes: Sequence[int], frames: int, samples: int, seed: int, progress: Progress = silent
) -> list[dict[str, float]]:
    """Rates of the ray caster and of Cycles at each size, and their ratio; every frame shows Earth."""
    if frames < 1 or not sizes:
        raise InputError("--frames must be at least 1 and --sizes name at least one side")
    rows = []
    with progress("frames", 2 * len(sizes)) as done:
        for size in sizes:
            rates = {}
            for renderer in ("raycast", "cycles"):
                rates[renderer] = _rate(FrameConfig(renderer, samples), size, frames, seed)
                done()
            rows.append({"size_px": size, **rates, "ratio": rates["raycast"] / rates["cycles"]})
    return rows


def _rate(config: FrameConfig, size: int, frames: int, seed: int) -> float:
    """Labelled images per second, written as PNG."""
    mission = load_mission("observation-10-100m")
    in_view = replace(mission, looks=replace(mission.looks, earth=1.0))
    scenes = draw_scenes(in_view, frames + _WARM, seed, size)
    make = FrameJob(mission.target, config)()
    with tempfile.TemporaryDirectory() as folder:
        writer = DatasetWriter(Path(folder) / "set")
        writer.begin(scenes, load_target(mission.target))
        start = 0.0
        for k, scene in enumerate(scenes):
            start = time.perf_counter() if k == _WARM else start
            frame = make(scene)
            writer.add(scene, frame.image, frame.mask, frame.label)
        return frames / (time.perf_counter() - start)


def table(found: dict[str, Any]) -> str:
    """The rates as text."""
    samples = found["record"]["options"]["samples"]
    lines = [f"{'size [px]':>9}  {'raycast [1/s]':>13}  {f'Cycles, {samples} samples [1/s]':>26}  {'ratio':>6}"]
    lines += [
        f"{r['size_px']:>9}  {r['raycast']:>13.2f}  {r['cycles']:>26.3f}  {r['ratio']:>6.1f}"
        for r in found["images_per_s"]
    ]
    return "\n".join(lines)
