"""Whether a renderer holds on: frame after frame in one process, its memory and handles at every tenth of the way.

    python tools/soak.py raycast 10000 32 --out benchmarks/results/scale      tiny frames, many
    python tools/soak.py cycles 500 64 --samples 1                            Blender's own process counts as well

Memory is what this process and its children hold alone: the maps of Earth and the libraries that they share with others
would seem to grow whenever another process ends. Handles are open file descriptors. Flat: from a tenth of the way to
the end memory grows by less than 5 % + 20 MB and handles not at all. The exit status says whether it was.
"""

import argparse
import gc
import json
import sys
import time
from pathlib import Path

import psutil

from proxnav.frames import FrameJob
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.rendering.config import FrameConfig, Renderer


def main() -> int:
    """Parses, soaks, judges."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("renderer", choices=("raycast", "cycles"))
    parser.add_argument("frames", type=int)
    parser.add_argument("size", type=int)
    parser.add_argument("--samples", type=int, default=1)
    parser.add_argument("--out", type=Path)
    options = parser.parse_args()
    found = soak(options.renderer, options.frames, options.size, options.samples)
    if options.out is not None:
        options.out.mkdir(parents=True, exist_ok=True)
        (options.out / f"soak-{options.renderer}.json").write_text(json.dumps(found, indent=1) + "\n")
    print(json.dumps(found, indent=1))
    return 0 if found["flat"] else 1


def soak(renderer: Renderer, frames: int, size: int, samples: int) -> dict:
    """Draws the frames and measures on the way."""
    mission = load_mission("observation-10-100m")
    make, marks, start = FrameJob(mission.target, FrameConfig(renderer, samples))(), [], time.monotonic()
    every = max(1, frames // 10)
    for scene in draw_scenes(mission, frames, 7, size):
        make(scene)
        if (scene.index + 1) % every == 0:
            marks.append({"frame": scene.index + 1, **measured(), "minutes": (time.monotonic() - start) / 60.0})
            print(marks[-1], file=sys.stderr, flush=True)
    first, last = marks[0], marks[-1]
    flat = last["memory_mb"] <= 1.05 * first["memory_mb"] + 20.0 and last["handles"] <= first["handles"]
    return {"renderer": renderer, "frames": frames, "size_px": size, "samples": samples, "flat": flat, "marks": marks}


def measured() -> dict[str, float]:
    """Private memory [MB] and open handles of this process and its children."""
    gc.collect()
    own = psutil.Process()
    family = [own, *own.children(recursive=True)]
    return {
        "memory_mb": round(sum(process.memory_full_info().uss for process in family) / 1e6, 1),
        "handles": sum(process.num_fds() for process in family),
    }


if __name__ == "__main__":
    sys.exit(main())
