"""A data set of rendered frames: over processes or machines, and on where a killed run stopped."""

import os
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path

from proxnav.cluster.jobs import POOL, is_elsewhere, run_anywhere
from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.set.writer import DatasetWriter, encode_frame
from proxnav.errors import InputError
from proxnav.frames import FrameConfig, FrameJob
from proxnav.records import SceneSpec
from proxnav.storage.files import read_json, write_json
from proxnav.storage.lock import LOCK, only_run_in
from proxnav.storage.run_record import plain, run_record
from proxnav.targets import Target
from proxnav.targets.loading import load_target


def render(
    scenes: Sequence[SceneSpec],
    config: FrameConfig,
    out: Path,
    workers: int,
    done: Callable[[], None] = lambda: None,
    on: str = POOL,
) -> Dataset:
    """A data set of the scenes' frames in `out`; a run that was interrupted goes on where it stopped.

    `done` is called after each frame, those that are already there included; `on` says where the workers are.
    """
    target, writer = load_target(scenes[0].target), DatasetWriter(out)
    writer.check(scenes)
    # Reading a finished set needs no lock and no leave to write; one that a killed run left there is taken and removed.
    is_done = (out / "annotations.json").exists() and not (out / LOCK).exists()
    with nullcontext() if is_done else only_run_in(out):
        return _render(scenes, target, config, writer, workers, done, on)


def _render(
    scenes: Sequence[SceneSpec], target: Target, config: FrameConfig, writer: DatasetWriter, workers: int,
    done: Callable[[], None], on: str,
) -> Dataset:  # fmt: skip
    out = writer.folder
    waiting = writer.begin(scenes, target)
    _record_rendering(out / "config.json", config, is_new=len(waiting) == len(scenes))
    for _ in range(len(scenes) - len(waiting)):
        done()
    if is_elsewhere(on):  # a worker there has one processor, and its files are not ours
        job = EncodeJob(FrameJob(target, replace(config, threads=config.threads or 1)))
    else:
        job = WriteJob(FrameJob(scenes[0].target, _share_cores(config, workers)), writer)
    for _, files in run_anywhere(job, waiting, min(workers, max(1, len(waiting))), on, lambda scene: scene.filename):
        writer.put(files)
        done()
    return Dataset(writer.finish(scenes, target))


def _record_rendering(path: Path, config: FrameConfig, is_new: bool) -> None:
    """Says in the data set how it is drawn; InputError where frames of it were drawn in another way."""
    if is_new:
        write_json(path, run_record(config), indent=1)
    elif path.exists():
        before, now = read_json(path, "how the set was rendered")["options"], plain(config)
        for name in ("renderer", "samples") if config.renderer == "cycles" else ("renderer",):
            if before.get(name) != now[name]:
                raise InputError(
                    f"{path.parent}: its frames were rendered with {name} {before.get(name)}, not {now[name]}; "
                    f"resume it with --{name} {before.get(name)} or give another --out"
                )


@dataclass(frozen=True)
class WriteJob:
    """Renders a scene and writes its frame, all in the worker: nothing travels back."""

    frames: FrameJob
    writer: DatasetWriter

    def __call__(self) -> Callable[[SceneSpec], dict[str, bytes]]:
        make = EncodeJob(self.frames)()

        def write(scene: SceneSpec) -> dict[str, bytes]:
            self.writer.put(make(scene))
            return {}

        return write


@dataclass(frozen=True)
class EncodeJob:
    """Renders a scene to the bytes of its files, for workers that do not see the data set's folder."""

    frames: FrameJob

    def __call__(self) -> Callable[[SceneSpec], dict[str, bytes]]:
        make = self.frames()

        def encode(scene: SceneSpec) -> dict[str, bytes]:
            frame = make(scene)
            return encode_frame(scene, frame.image, frame.mask, frame.label)

        return encode


def _share_cores(config: FrameConfig, workers: int) -> FrameConfig:
    """Cycles uses all cores of its process: several workers divide them."""
    if config.threads or workers <= 1:
        return config
    return replace(config, threads=max(1, (os.cpu_count() or 1) // workers))
