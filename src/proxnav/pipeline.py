"""The flow as prose: scenes -> frames -> data set -> keypoints -> poses -> errors; each stage one call."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from proxnav.cluster.local import run_jobs
from proxnav.datasets.dataset import Dataset
from proxnav.datasets.records import SceneSpec
from proxnav.datasets.writer import DatasetWriter
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Camera
from proxnav.presets import Preset
from proxnav.scenes.random_scene import random_scene
from proxnav.targets.loading import load_target


def draw_scenes(preset: Preset, frames: int, seed: int, size: int | None = None) -> list[SceneSpec]:
    """Scenes of a preset, each a function of (seed, index) alone; `size` resamples the square camera."""
    camera = resized(preset.camera, size)
    return [random_scene(index, seed, preset.scenes, preset.target, camera) for index in range(frames)]


def resized(camera: Camera, size: int | None) -> Camera:
    """The camera with its longer side at `size` pixels; unchanged for None."""
    if size is None:
        return camera
    scale = size / max(camera.width, camera.height)
    return camera.resized(round(camera.width * scale), round(camera.height * scale))


def render(
    scenes: Sequence[SceneSpec], config: FrameConfig, out: Path, workers: int, done: Callable[[], None] = lambda: None
) -> Dataset:
    """A data set of the scenes' frames in `out`; a run that was interrupted goes on where it stopped.

    `done` is called after each frame, those that are already there included.
    """
    target = load_target(scenes[0].target)
    writer = DatasetWriter(out)
    waiting = writer.begin(scenes, target)
    for _ in range(len(scenes) - len(waiting)):
        done()
    job = _WriteJob(FrameJob(scenes[0].target, _share_cores(config, workers)), writer)
    for _ in run_jobs(job, waiting, min(workers, max(1, len(waiting)))):
        done()
    return Dataset(writer.finish(scenes, target))


@dataclass(frozen=True)
class _WriteJob:
    """Renders a scene and writes its frame, all in the worker: only the index travels back."""

    frames: FrameJob
    writer: DatasetWriter

    def __call__(self) -> Callable[[SceneSpec], int]:
        make = self.frames()

        def write(scene: SceneSpec) -> int:
            frame = make(scene)
            self.writer.add(scene, frame.image, frame.mask, frame.label)
            return scene.index

        return write


def _share_cores(config: FrameConfig, workers: int) -> FrameConfig:
    """Cycles uses all cores of its process: several workers divide them."""
    if config.threads or workers <= 1:
        return config
    return replace(config, threads=max(1, (os.cpu_count() or 1) // workers))
