"""Trained networks as a model folder that runs without torch, its covariances calibrated."""

from dataclasses import replace
from pathlib import Path

from proxnav.cluster.progress import Progress, silent
from proxnav.detection.heatmap.config import HeatmapNetConfig, HeatmapSettings
from proxnav.detection.heatmap.export import FindTarget, ReadKeypoints, export
from proxnav.detection.heatmap.finder import FinderNet
from proxnav.detection.heatmap.network import HeatmapNet
from proxnav.detection.training.files import load_weights
from proxnav.estimator import PoseEstimator
from proxnav.learning.pose_calibration import (
    CalibrationFrames,
    calibrated_alignment,
    least_median_score,
    spread_scale,
)
from proxnav.learning.trust_calibration import calibrate_trust
from proxnav.missions import MISSION, Mission, write_mission
from proxnav.models.card import ModelCard, write_card
from proxnav.pose.align import AlignConfig
from proxnav.storage.files import filling
from proxnav.targets.loading import GENERATED, load_target
from proxnav.targets.target_files import save_target


def export_heatmap_model(
    crop: Path, finder: Path, out: Path, mission: Mission, net: HeatmapNetConfig, settings: HeatmapSettings,
    calibration: int, least: float | None = None, progress: Progress = silent, trust: int = 0,
) -> ModelCard:  # fmt: skip
    """Writes crop.onnx, finder.onnx, their weights, model.json and mission.toml into `out`: all of them, or nothing.

    Covariances are scaled on `calibration` fresh frames, trust on `trust` frames under each condition (0: not at all);
    the least median score is measured where `least` is None.
    """
    with filling(out) as folder:
        return _export(crop, finder, folder, mission, net, settings, calibration, least, progress, trust)


def _export(
    crop: Path, finder: Path, folder: Path, mission: Mission, net: HeatmapNetConfig, settings: HeatmapSettings,
    calibration: int, least: float | None, progress: Progress, trust: int,
) -> ModelCard:  # fmt: skip
    target = load_target(mission.target)
    _export_networks(HeatmapNet(net, len(target.keypoint_names)), crop, finder, folder, settings)
    card = ModelCard(target.name, target.keypoint_names, target.keypoints_m, settings, network=net)
    write_card(folder, card)
    write_mission(folder / MISSION, mission)
    if target.name not in GENERATED:
        save_target(target, folder / "target")
    estimator, frames = PoseEstimator.load(str(folder)), CalibrationFrames(mission, calibration, progress)
    least = least_median_score(estimator, frames) if least is None else least
    scale = spread_scale(replace(estimator, least_median_score=least), frames)
    settings = replace(settings, spread_scale=round(scale, 4))
    card = replace(card, settings=settings, least_median_score=round(least, 4), alignment=AlignConfig())
    write_card(folder, card)
    card = replace(card, alignment=calibrated_alignment(PoseEstimator.load(str(folder)), frames))
    write_card(folder, card)
    return calibrate_trust(folder, mission, trust, progress=progress) if trust else card


def _export_networks(net: HeatmapNet, crop: Path, finder: Path, out: Path, settings: HeatmapSettings) -> None:
    finder_net = FinderNet()
    load_weights(net, crop)
    load_weights(finder_net, finder)
    export(ReadKeypoints(net), ReadKeypoints.OUTPUTS, settings.crop_side, out, "crop")
    export(FindTarget(finder_net), ("probability",), settings.finder_side, out, "finder")
