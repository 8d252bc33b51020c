"""Resident memory over many frames of either renderer, every 50 frames: flat, or what grows.

    python tools/memory_soak.py [--frames 1000] [--renderers raycast cycles] [--out FOLDER]

Small frames of random scenes, textures new in each, Earth in half: what could pile up does so by number, not by pixel.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

from proxnav.frames import FrameConfig, FrameJob
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import SceneSpec
from proxnav.rendering.cycles import CyclesConfig
from proxnav.rendering.cycles.renderer import CyclesRenderer
from proxnav.sensor.expose import expose
from proxnav.storage.files import write_json
from proxnav.targets.loading import load_target

STEP, SIDE = 50, 96


def main() -> None:
    """Prints the series of each renderer and what the second half added to the first."""
    options = _parse()
    mission = load_mission("observation-10-100m")
    found = {}
    for name in options.renderers:
        scenes = draw_scenes(mission, options.frames, 0, SIDE)
        series = np.array((raycast if name == "raycast" else cycles)(scenes, mission.target))
        print(name, series.round().astype(int).tolist(), flush=True)
        settled = series[len(series) // 5 :]
        slope = np.polyfit(np.arange(len(settled)) * STEP / 1000.0, settled, 1)[0]
        growth = {"first_mb": settled[0].tolist(), "last_mb": settled[-1].tolist(), "mb_per_1000": slope.tolist()}
        print(name, growth, flush=True)
        found[name] = growth | {"every": STEP, "rss_mb": series.tolist()}
    if options.out:
        write_json(options.out / "memory.json", found, indent=1)


def raycast(scenes: list[SceneSpec], target: str) -> list[list[float]]:
    """[own] MB after every STEP labelled frames."""
    make, series = FrameJob(target, FrameConfig("raycast"))(), []
    for k, scene in enumerate(scenes, start=1):
        make(scene)
        if k % STEP == 0:
            series.append([own_mb()])
    return series


def cycles(scenes: list[SceneSpec], target: str) -> list[list[float]]:
    """[own, worker's] MB after every STEP frames, by one worker that is never replaced."""
    series = []
    config = CyclesConfig(samples=2, memory_limit_mb=1e9)
    with CyclesRenderer(load_target(target), config) as renderer:
        for k, scene in enumerate(scenes, start=1):
            expose(renderer.render(replace(scene, index=k)), scene)
            if k % STEP == 0:
                assert renderer._worker is not None
                series.append([own_mb(), renderer._worker.memory_mb])
    return series


def own_mb() -> float:
    """Resident memory of this process, without pages that are only mapped from files."""
    fields = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return float(fields["RssAnon"].split()[0]) / 1024.0


def _parse() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--renderers", nargs="+", default=["raycast", "cycles"], choices=["raycast", "cycles"])
    parser.add_argument("--out", type=Path)
    return parser.parse_args()


if __name__ == "__main__":
    main()
