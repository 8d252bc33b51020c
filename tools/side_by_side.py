"""Processor time of a 512 px frame, of `estimate_pose` and of the filter in two trees, taken in turn.

python tools/side_by_side.py OLD NEW [--rounds 4], where each is a checkout of proxnav; both run in this environment,
with one thread, and the least of the rounds counts.
"""

import argparse
import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import numpy as np

THREADS = dict.fromkeys(("OMP_NUM_THREADS", "NUMBA_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
FRAMES, POSES = 10, 50


def main() -> None:
    """Parses, measures each tree in turn, prints the least of each figure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("trees", nargs="*", type=Path)
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--this-tree", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.this_tree:
        print(json.dumps({"frame_ms": frame_ms(), "solve_ms": solve_ms()} | filter_ms()))
        return
    found: dict[Path, list[dict[str, float]]] = {tree: [] for tree in options.trees}
    for _ in range(options.rounds + 1):  # the first compiles
        for tree, rows in found.items():
            rows.append(measured(tree))
    for tree, rows in found.items():
        print(tree, {key: round(min(row[key] for row in rows[1:]), 4) for key in rows[0]})


def measured(tree: Path) -> dict[str, float]:
    """The figures of one tree, in a process of its own."""
    surroundings = os.environ | THREADS | {"PYTHONPATH": str(tree.resolve() / "src")}
    words = [sys.executable, str(Path(__file__).resolve()), "--this-tree"]
    done = subprocess.run(words, env=surroundings, capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def frame_ms() -> float:
    """A ray-cast frame of 512 px with Earth: mean over frames of the least of three."""
    from proxnav.geometry import Camera
    from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
    from proxnav.scenes.random_scene import RandomSceneConfig, random_scene
    from proxnav.targets.loading import load_target

    camera = Camera(512, 512, 703.5, 703.5, 256.0, 256.0)
    renderer = RaycastRenderer(load_target("space-rider"), RaycastConfig())
    scenes = [random_scene(k, 5, RandomSceneConfig(), "space-rider", camera) for k in range(FRAMES)]
    return float(np.mean([least_ms(lambda scene=scene: renderer.render(scene), 4) for scene in scenes]))


def solve_ms() -> float:
    """`estimate_pose` from 24 keypoints with a pixel of noise."""
    import proxnav
    from proxnav.geometry import Camera
    from proxnav.scenes.random_scene import RandomSceneConfig, random_scene
    from proxnav.targets.loading import load_target

    camera, points_m = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0), load_target("space-rider").keypoints_m
    scenes = [random_scene(k, 6, RandomSceneConfig(), "space-rider", camera) for k in range(POSES)]
    noise_px, n = np.random.default_rng(0), len(points_m)
    pixels = [camera.project(scene.T_cam_target @ points_m) + noise_px.normal(size=(n, 2)) for scene in scenes]
    covariances, scores = np.tile(np.eye(2), (n, 1, 1)), np.full(n, 0.9)

    def solve_all() -> None:
        for points_px in pixels:
            proxnav.estimate_pose(points_m, points_px, camera, covariances, scores)

    return least_ms(solve_all, 60) / POSES


def filter_ms() -> dict[str, float]:
    """Prediction and update of the filter, as its benchmark times them."""
    from proxnav.geometry import Camera

    try:
        speed = import_module("proxnav.benchmarks.filter_speed")
    except ModuleNotFoundError:  # release 0.1 had it elsewhere
        speed = import_module("proxnav.navigation.speed")
    found = speed.measure_speed(Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0), "space-rider")
    return {key: value for key, value in found.items() if isinstance(value, float)}


def least_ms(job: Callable[[], object], times: int) -> float:
    """Least processor time of a job; the first run warms up."""
    taken = []
    for _ in range(times):
        start = time.process_time()
        job()
        taken.append(time.process_time() - start)
    return 1e3 * min(taken[1:])


if __name__ == "__main__":
    main()
