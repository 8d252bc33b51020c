"""The flow as prose: scenes -> frames -> data set -> keypoints -> poses -> errors; each stage one call."""

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool

from proxnav.cluster.local import run_jobs
from proxnav.datasets.dataset import Dataset, encode_png
from proxnav.datasets.files import read_json, write_atomic, write_json
from proxnav.datasets.records import SceneSpec, Trajectory
from proxnav.datasets.run_record import plain, run_record
from proxnav.datasets.speed import PoseRecord, write_poses
from proxnav.datasets.writer import DatasetWriter
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.evaluation.consistency import Consistency, consistency
from proxnav.evaluation.metrics import metrics
from proxnav.evaluation.pairing import Frame, pair
from proxnav.evaluation.summary import Summary, by_range, summarise_frames
from proxnav.evaluation.table import consistency_line, range_table, table1
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Camera
from proxnav.geometry.arrays import unit
from proxnav.presets import Preset
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.scenes.random_scene import random_scene
from proxnav.targets.loading import load_target
from proxnav.trajectories import select, spread
from proxnav.viewing.overlay import caption, overlay
from proxnav.viewing.run_folder import overlay_files

LARGEST_SIDE_PX = 16_384


def draw_scenes(preset: Preset, frames: int, seed: int, size: int | None = None) -> list[SceneSpec]:
    """Scenes of a preset, each a function of (seed, index) alone; `size` resamples the square camera."""
    _check_order(frames, seed)
    camera = resized(preset.camera, size)
    return [random_scene(index, seed, preset.scenes, preset.target, camera) for index in range(frames)]


def follow(trajectory: Trajectory, preset: Preset, frames: int, seed: int, size: int | None = None) -> list[SceneSpec]:
    """`frames` scenes spread evenly over the observable part of a trajectory; over all of it if there is none."""
    _check_order(frames, seed)
    usable = observable(trajectory, preset.scenes.sun.max_phase_rad)
    seen = spread(select(trajectory, usable) if usable.any() else trajectory, frames)
    camera = resized(preset.camera, size)
    config = SceneConfig(sensor=preset.scenes.sensor, cloud_seed=seed, sequence=seen.source)
    return [
        scene_at(seen, k, index=k, target=preset.target, camera=camera, config=config, seed=seed)
        for k in range(len(seen))
    ]


def _check_order(frames: int, seed: int) -> None:
    if frames < 1 or seed < 0:
        raise InputError(f"a set needs at least 1 frame and a seed from 0 on, found {frames} frames and seed {seed}")


def observable(trajectory: Trajectory, max_phase_rad: float) -> Bool[np.ndarray, "n"]:
    """Instants at which the target is sunlit and the angle Sun-target-camera is at most `max_phase_rad`."""
    to_camera = unit(trajectory.r_eci_chaser_m - trajectory.r_eci_target_m)
    cosine = np.einsum("ni,ni->n", to_camera, trajectory.sun_eci)
    return (trajectory.sun_visible > 0.5) & (cosine > np.cos(max_phase_rad))


def resized(camera: Camera, size: int | None) -> Camera:
    """The camera with its longer side at `size` pixels; unchanged for None."""
    if size is None:
        return camera
    if not 1 <= size <= LARGEST_SIDE_PX:
        raise InputError(f"an image needs 1 to {LARGEST_SIDE_PX} px on its longer side, found {size}")
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
    _record_rendering(out / "config.json", config, is_new=len(waiting) == len(scenes))
    for _ in range(len(scenes) - len(waiting)):
        done()
    job = _WriteJob(FrameJob(scenes[0].target, _share_cores(config, workers)), writer)
    for _ in run_jobs(job, waiting, min(workers, max(1, len(waiting)))):
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


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """Estimates of a data set beside its truth."""

    records: tuple[PoseRecord, ...]
    truth: tuple[PoseRecord, ...]
    frames: tuple[Frame, ...]
    summary: Summary
    consistency: Consistency | None

    def metrics(self) -> dict[str, Any]:
        """The numbers of `metrics.json`."""
        return metrics(self.summary, self.consistency)

    def text(self) -> str:
        """The study's Table 1 beside ours, errors by range, honesty of the covariances."""
        return f"{table1(self.summary)}\n\n{range_table(by_range(self.frames))}\n\n{consistency_line(self.consistency)}"


def judge(records: Sequence[PoseRecord], dataset: Dataset) -> Judgement:
    """Errors of the estimates of a data set."""
    truth = truth_of(dataset)
    frames = pair({record.filename: record for record in records}, {record.filename: record for record in truth})
    return Judgement(tuple(records), truth, frames, summarise_frames(frames), consistency(frames))


def truth_of(dataset: Dataset) -> tuple[PoseRecord, ...]:
    """The true poses of a data set."""
    return tuple(PoseRecord(label.filename, label.T_cam_target, "truth") for label in dataset.labels)


def write_run(
    out: Path, judgement: Judgement, dataset: Dataset, estimator: PoseEstimator, options: Any, each: int = 10
) -> None:
    """poses.json, truth.json, metrics.json, config.json, and overlays of the `each` best, median and worst frames.

    `options` is the dataclass that the run was asked with.
    """
    write_poses(out / "poses.json", judgement.records)
    write_poses(out / "truth.json", judgement.truth)
    write_json(out / "metrics.json", judgement.metrics(), indent=1)
    write_json(out / "config.json", run_record(options), indent=1)
    for stale in overlay_files(out / "overlays"):
        stale.unlink()
    errors = [np.inf if frame.errors is None else frame.errors.e_c for frame in judgement.frames]
    for name, index in telling(np.argsort(errors, kind="stable"), each):
        write_atomic(out / "overlays" / f"{name}.png", encode_png(draw(index, judgement, dataset, estimator)))


def telling(order: np.ndarray, each: int) -> list[tuple[str, int]]:
    """(name, frame) of up to `each` best, median and worst frames of an order from best to worst; each frame once.

    Where there are too few for all, each kind has a third of them.
    """
    n = len(order)
    best, median, worst = (min(each, (n + extra) // 3) for extra in (2, 0, 1))
    middle = min(max((n - median) // 2, best), n - worst - median)
    places = {"best": (0, best), "median": (middle, median), "worst": (n - worst, worst)}
    return [
        (f"{kind}-{place:04d}", int(order[place]))
        for kind, (start, count) in places.items()
        for place in range(start, start + count)
    ]


def draw(index: int, judgement: Judgement, dataset: Dataset, estimator: PoseEstimator) -> np.ndarray:
    """One frame with what was found in it and what is true."""
    frame, image = judgement.frames[index], dataset.image(index)
    keypoints, _ = estimator.observe(image, dataset.camera)
    canvas = overlay(image, dataset.camera, frame.T_est, frame.T_true, estimator.points_target_m, keypoints)
    found, errors = frame.status, frame.errors
    if errors is not None:
        turn = np.degrees(errors.e_r_rad)
        found = f"E_T {errors.e_t_norm_m:.2f} m, E_R {turn:.2f} deg, E_C {errors.e_c:.4f}"
    return caption(canvas, [f"{frame.filename}  range {frame.range_m:.1f} m", found])
