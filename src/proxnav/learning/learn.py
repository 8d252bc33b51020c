"""`learn`: from a mission to a model with measured errors, in stages of which each resumes where it stopped."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from proxnav.cluster.progress import Progress, silent
from proxnav.detection.heatmap.config import HeatmapNetConfig, HeatmapSettings, TrainFinderConfig, TrainHeatmapConfig
from proxnav.detection.training.config import LoopConfig
from proxnav.errors import InputError
from proxnav.evaluation.judgement import Judgement
from proxnav.learning.heatmap_export import export_heatmap_model
from proxnav.learning.heatmap_training import crop_training, finder_training
from proxnav.learning.training import Training
from proxnav.measured_set import measure_set
from proxnav.missions import MISSION, Mission, load_mission, write_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.models.loading import SHIPPED
from proxnav.rendering.config import FrameConfig, Renderer
from proxnav.viewing.run_writer import write_report

FINDER_SHARE, SMALL_SHARE, LARGE_SHARE = 0.15, 0.45, 0.25
"""Shares of the hours: the finder, the crop network on small and then on large crops; the rest calibrates and measures.
A finder is soon good enough, and small crops teach most of what large ones do at a third of the time."""
_CONDITIONS = 15
"""Trust is calibrated on twenty conditions, with this much fewer frames under each than calibrate the covariances."""
SMALL_PX, LARGE_PX, FINDER_PX = 128, 192, 256
_REPEATS = 3
"""Times that a drawn image is learnt from: on two cores, one draws as fast as the other learns (AMX)."""
_MANY_STEPS = 10**7
"""Time ends a stage, not its steps."""
_NEAREST = SHIPPED / "space-rider"
_SEED = 11_000
"""Seed of the frames that the model is measured on; nothing learns from them and nothing is chosen by them."""


@dataclass(frozen=True, slots=True)
class Effort:
    """How much goes into a model."""

    hours: float = 1.0
    """Time of all parts of the training together; a longer one continues it."""
    calibration: int = 150
    """Fresh ray-cast frames on which covariances are scaled."""
    raycast: int = 100
    """Ray-cast frames that the model is measured on."""
    cycles: int = 12
    """Frames of Cycles that it is measured on; 0 leaves them out."""
    workers: int = 0
    """Processes that draw; 0 takes one a processor."""

    def __post_init__(self) -> None:
        if not 0.0 < self.hours < 1e4:
            raise InputError(f"--hours {self.hours:g}: give the time of the training, 1 for a first model")
        if self.calibration < 60 or self.raycast < 1 or self.cycles < 0:
            raise InputError("a model is calibrated on 60 frames or more and measured on 1 ray-cast frame or more")


def learn(
    mission: Mission, out: Path, effort: Effort, options: Any, progress: Progress = silent
) -> dict[Renderer, Judgement]:
    """Trains, exports, calibrates and measures a model of the mission into `out`; the same call resumes.

    `out/model` is the model, `out/raycast` and `out/cycles` are runs with their reports. `options` is the dataclass
    that the run was asked with. InputError where `out` belongs to another mission.
    """
    _claim(out, mission)
    _train(mission, out, effort, options)
    export_heatmap_model(
        out / "crop-large" / "weights.safetensors", out / "finder" / "weights.safetensors", out / "model", mission,
        HeatmapNetConfig(), HeatmapSettings(LARGE_PX, FINDER_PX), effort.calibration, progress=progress,
        trust=effort.calibration // _CONDITIONS,
    )  # fmt: skip
    return _measured(mission, out, effort, options, progress)


def _claim(out: Path, mission: Mission) -> None:
    path = out / MISSION
    if path.is_file() and load_mission(path) != mission:
        raise InputError(f"{out} learns another mission, {path}; resume that one or give another --out")
    write_mission(path, mission)


def _train(mission: Mission, out: Path, effort: Effort, options: Any) -> None:
    """The stages in their order; one that has had its share of the hours is over at once."""
    workers = effort.workers or os.cpu_count() or 1
    find = TrainFinderConfig(_loop(16, FINDER_SHARE * effort.hours), start=_NEAREST / "finder.safetensors")
    _run("finder", finder_training(find, mission, FINDER_PX, 2, workers, _REPEATS), out / "finder", options)
    start = TrainHeatmapConfig(loop=_loop(32, SMALL_SHARE * effort.hours), trunk=_NEAREST / "crop.safetensors")
    small = crop_training(start, mission, SMALL_PX, 1, workers, _REPEATS, 64)
    _run(f"keypoints at {SMALL_PX} px", small, out / "crop-small", options)
    config = TrainHeatmapConfig(
        loop=_loop(16, LARGE_SHARE * effort.hours), rate=5e-4, start=out / "crop-small" / "weights.safetensors"
    )
    large = crop_training(config, mission, LARGE_PX, 3, workers, _REPEATS, 64)
    _run(f"keypoints at {LARGE_PX} px", large, out / "crop-large", options)


def _loop(batch: int, hours: float) -> LoopConfig:
    return LoopConfig(
        steps=_MANY_STEPS, batch_size=batch, hours=hours, log_every=10, save_every=100, validate_every=200,
        average_decay=0.995,
    )  # fmt: skip


def _run(stage: str, training: Training, folder: Path, options: Any) -> None:
    result = training.run(folder, options)
    score = "" if result.best_score != result.best_score else f", {result.best_score:.2f} px on crops kept aside"
    print(f"{stage}: {result.samples} images learnt from{score}", flush=True)


def _measured(
    mission: Mission, out: Path, effort: Effort, options: Any, progress: Progress
) -> dict[Renderer, Judgement]:
    """Errors on frames of both renderers, each in a run of its own with a report."""
    counts: dict[Renderer, int] = {"raycast": effort.raycast, "cycles": effort.cycles}
    found: dict[Renderer, Judgement] = {}
    for renderer, count in counts.items():
        if count:
            folder = out / renderer
            scenes = draw_scenes(mission, count, _SEED)
            name = f"images-{mission.name}-{count}"
            found[renderer] = measure_set(
                folder, name, scenes, FrameConfig(renderer), str(out / "model"), options, progress=progress
            )
            write_report(folder, f"{mission.name}: {renderer}")
    return found
