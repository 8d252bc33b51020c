"""Frames per second of ray casting on one core, by size, with and without Earth, in processor time.

    python tools/raycast_speed.py

Each size is a crop whose camera shows Space Rider at 20 m so that it fills four fifths of it, as a network sees it.
"""

import time
from dataclasses import replace

import numpy as np

from proxnav.geometry import Camera
from proxnav.records import SceneSpec, TextureSpec
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.scenes import RandomSceneConfig, random_scene
from proxnav.targets.loading import load_target

CONFIGS = {
    "default": RaycastConfig(),
    "training": RaycastConfig(samples=4, sun_samples=4, bounces=1, ambient_rays=48, environment_rows=16),
}
FRAMES = {128: 40, 256: 16, 512: 8, 1024: 4}
RANGE_M = 20.0


def main() -> None:
    """Prints one row per size and configuration."""
    target = load_target("space-rider")
    print("config    size   black [1/s]   Earth [1/s]   target share")
    for name, config in CONFIGS.items():
        renderer = RaycastRenderer(target, config)
        for size, frames in FRAMES.items():
            rates, share = [], 0.0
            for earth in (False, True):
                rate, share = measure(renderer, [scene(i, size, earth, target.radius_m) for i in range(frames)])
                rates.append(rate)
            print(f"{name:9s} {size:4d} {rates[0]:13.1f} {rates[1]:13.1f} {share:14.2f}", flush=True)


def measure(renderer: RaycastRenderer, scenes: list[SceneSpec]) -> tuple[float, float]:
    """(frames per second of processor time, mean share of pixels on the target); kernels and tables are warm."""
    renderer.render(scenes[0])
    start, seen = time.process_time(), 0.0
    for spec in scenes:
        seen += float(renderer.render(spec).mask.mean()) / len(scenes)
    return len(scenes) / (time.process_time() - start), seen


def scene(index: int, size: int, earth: bool, radius_m: float) -> SceneSpec:
    """A random scene brought to 20 m before the camera's centre."""
    f = 0.4 * size * RANGE_M / radius_m
    camera = Camera(size, size, f, f, size / 2, size / 2)
    spec = random_scene(index, 1, RandomSceneConfig(earth=earth), "space-rider", camera)
    # the clouds of one seed and the nominal texture: what a frame costs, not what a new texture costs
    clouds = None if spec.earth is None else replace(spec.earth, cloud_cover=0.5, cloud_seed=0)
    nominal = replace(spec, earth=clouds, texture=TextureSpec())
    return replace(nominal, t_cam_target_m=tuple((RANGE_M * np.array([0.0, 0.0, 1.0])).tolist()))


if __name__ == "__main__":
    main()
