"""The flow as prose: scenes -> frames -> data set -> keypoints -> poses -> errors; each stage one call."""

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from proxnav.cluster.jobs import POOL, is_elsewhere, run_anywhere
from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.set.writer import DatasetWriter, encode_frame
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.evaluation.consistency import Consistency, Efficiency, consistency, efficiency_by_range
from proxnav.evaluation.metrics import metrics
from proxnav.evaluation.pairing import PairedFrame, from_best_to_worst, pair
from proxnav.evaluation.run_folder import CONFIG, METRICS, OVERLAYS, POSES, TRUTH, overlay_files, telling
from proxnav.evaluation.run_frames import FrameNote, RunFrames, write_run_frames
from proxnav.evaluation.summary import Summary, by_range, summarise_frames
from proxnav.evaluation.table import consistency_line, efficiency_table, range_table, table1
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Camera
from proxnav.geometry.arrays import unit
from proxnav.geometry.types import Points
from proxnav.images.codecs import encode_png
from proxnav.missions import Mission
from proxnav.pose.solve.crlb import cramer_rao_white
from proxnav.records import VISIBLE, FrameLabel, Keypoints, SceneSpec, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.scenes.random_scene import random_scene
from proxnav.storage.files import read_json, write_atomic, write_json
from proxnav.storage.lock import LOCK, only_run_in
from proxnav.storage.run_record import plain, run_record
from proxnav.targets import Target
from proxnav.targets.loading import load_target
from proxnav.trajectories import select, spread
from proxnav.viewing.overlay import caption, overlay

LARGEST_SIDE_PX = 16_384
EFFICIENCY_EDGES_M = (10.0, 15.0, 25.0, 40.0, 60.0, 70.0, 90.0, 110.0)
"""Bins round 20, 50 and 80 m, and what lies between."""


def draw_scenes(mission: Mission, frames: int, seed: int, size: int | None = None) -> list[SceneSpec]:
    """Scenes of a mission, each a function of (seed, index) alone; `size` resamples the square camera."""
    _check_order(frames, seed)
    camera = resized(mission.camera, size)
    return [random_scene(index, seed, mission.scenes, mission.target, camera) for index in range(frames)]


def follow(
    trajectory: Trajectory, mission: Mission, frames: int, seed: int, size: int | None = None
) -> list[SceneSpec]:
    """`frames` scenes spread evenly over the observable part of a trajectory; over all of it if there is none."""
    _check_order(frames, seed)
    usable = observable(trajectory, mission.scenes.sun.max_phase_rad)
    seen = spread(select(trajectory, usable) if usable.any() else trajectory, frames)
    camera = resized(mission.camera, size)
    config = SceneConfig(sensor=mission.sensor, cloud_seed=seed, sequence=seen.source)
    return [
        scene_at(seen, k, index=k, target=mission.target, camera=camera, config=config, seed=seed)
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


@dataclass(frozen=True, slots=True, eq=False)
class Judgement:
    """Estimates of a data set beside its truth."""

    records: tuple[PoseRecord, ...]
    truth: tuple[PoseRecord, ...]
    frames: tuple[PairedFrame, ...]
    summary: Summary
    consistency: Consistency | None
    efficiency: Mapping[tuple[float, float], Efficiency]
    """Errors over the Cramer-Rao bound, at `EFFICIENCY_EDGES_M`."""

    def metrics(self) -> dict[str, Any]:
        """The numbers of `metrics.json`."""
        return metrics(self.summary, self.consistency, self.efficiency)

    def text(self) -> str:
        """The study's Table 1 beside ours, errors by range and over the bound, honesty of the covariances."""
        tables = (table1(self.summary), range_table(by_range(self.frames)), efficiency_table(self.efficiency))
        return "\n\n".join((*tables, consistency_line(self.consistency)))


def judge(records: Sequence[PoseRecord], dataset: Dataset) -> Judgement:
    """Errors of the estimates of a data set."""
    truth = truth_of(dataset)
    frames = pair({record.filename: record for record in records}, {record.filename: record for record in truth})
    bounds = {label.filename: best_covariance(label, dataset.keypoints_m, dataset.camera) for label in dataset.labels}
    known = {name: bound for name, bound in bounds.items() if bound is not None}
    efficiency = efficiency_by_range(frames, known, EFFICIENCY_EDGES_M)
    return Judgement(tuple(records), truth, frames, summarise_frames(frames), consistency(frames), efficiency)


def truth_of(dataset: Dataset) -> tuple[PoseRecord, ...]:
    """The true poses of a data set."""
    return tuple(PoseRecord(label.filename, label.T_cam_target, "truth") for label in dataset.labels)


def write_run(
    out: Path,
    judgement: Judgement,
    dataset: Dataset,
    estimator: PoseEstimator,
    options: Any,
    each: int = 10,
    keypoints: Sequence[Keypoints] | None = None,
) -> None:
    """poses, truth, metrics, config and frames as .json, and overlays of the `each` best, median and worst frames.

    `options` is the dataclass that the run was asked with; without `keypoints` the detector looks at every frame again.
    """  # fmt: skip
    write_poses(out / POSES, judgement.records)
    write_poses(out / TRUTH, judgement.truth)
    write_json(out / METRICS, judgement.metrics(), indent=1)
    write_json(out / CONFIG, run_record(options), indent=1)
    if keypoints is None:
        keypoints = [estimator.observe(dataset.image(k), dataset.camera)[0] for k in range(len(dataset))]
    write_run_frames(out, notes_of(dataset, estimator.points_target_m, keypoints))
    for stale in overlay_files(out / OVERLAYS):
        stale.unlink()
    for name, index in telling(from_best_to_worst(judgement.frames), each):
        picture = draw(index, judgement, dataset, estimator.points_target_m, keypoints[index])
        write_atomic(out / OVERLAYS / name, encode_png(picture))


def notes_of(dataset: Dataset, points_target_m: Points, keypoints: Sequence[Keypoints]) -> RunFrames:
    """What each frame was: its time, the Sun, the best that its keypoints allow, and what the detector found."""
    scenes = list(dataset.scenes()) if (dataset.folder / "scenes.jsonl").is_file() else [None] * len(dataset)
    flown = scenes[0] is not None and bool(scenes[0].sequence)
    notes = [
        FrameNote.of(
            label.filename,
            scene.t if scene is not None and flown else float(k),
            np.nan if scene is None else phase_angle(scene),
            reachable(label, points_target_m, dataset.camera),
            found,
        )
        for k, (label, scene, found) in enumerate(zip(dataset.labels, scenes, keypoints, strict=True))
    ]
    target = dataset.target_name if scenes[0] is None else scenes[0].target
    epoch = scenes[0].epoch_utc if scenes[0] is not None and flown else ""
    return RunFrames(tuple(notes), dataset.camera, points_target_m, target, epoch, dataset.folder)


def phase_angle(scene: SceneSpec) -> float:
    """Angle Sun, target, camera [rad]: 0 with the Sun behind the camera."""
    to_camera = unit(scene.T_cam_target.inverse().t_m)
    return float(np.arccos(np.clip(to_camera @ np.array(scene.sun.direction_target), -1.0, 1.0)))


def reachable(label: FrameLabel, points_target_m: Points, camera: Camera) -> tuple[float, float]:
    """(E_T [m], E_R [rad]) of the Cramer-Rao bound for the visible keypoints, each known to 1 px per axis; or NaN."""
    bound = best_covariance(label, points_target_m, camera)
    if bound is None:
        return float("nan"), float("nan")
    return float(np.sqrt(np.trace(bound[:3, :3]))), float(np.sqrt(np.trace(bound[3:, 3:])))


def best_covariance(label: FrameLabel, points_target_m: Points, camera: Camera) -> Float[np.ndarray, "6 6"] | None:
    """The Cramer-Rao bound itself; None where fewer than four keypoints are in sight or they do not fix a pose."""
    visible = label.visibility == VISIBLE
    if len(visible) != len(points_target_m) or visible.sum() < 4:
        return None
    try:
        with np.errstate(divide="ignore", invalid="ignore"):  # points that are all one are refused, not warned of
            return cramer_rao_white(label.T_cam_target, points_target_m[visible], camera)
    except InputError:
        return None


def draw(
    index: int, judgement: Judgement, dataset: Dataset, points_target_m: Points, keypoints: Keypoints
) -> np.ndarray:
    """One frame with what was found in it and what is true."""
    frame, image = judgement.frames[index], dataset.image(index)
    canvas = overlay(image, dataset.camera, frame.T_est, frame.T_true, points_target_m, keypoints)
    found, errors = frame.status, frame.errors
    if errors is not None:
        turn = np.degrees(errors.e_r_rad)
        found = f"E_T {errors.e_t_norm_m:.2f} m, E_R {turn:.2f} deg, E_C {errors.e_c:.4f}"
    return caption(canvas, [f"{frame.filename}  range {frame.range_m:.1f} m", found])
