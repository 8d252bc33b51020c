"""`proxnav train export`: trained networks as a model folder that runs without torch, its covariances calibrated."""

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.cli.progress import progress
from proxnav.detection.heatmap.export import FindTarget, ReadKeypoints, export
from proxnav.detection.heatmap.finder import FinderConfig, FinderNet
from proxnav.detection.heatmap.network import HeatmapNet, HeatmapNetConfig
from proxnav.detection.training.files import load_weights
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator, write_model_card
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference
from proxnav.learning.alignment_calibration import KEPT, Samples, calibrated
from proxnav.learning.crops import BEHIND_M
from proxnav.missions import Mission, load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.pose.align import AlignConfig
from proxnav.targets.loading import GENERATED, load_target, save_target

_CALIBRATION_SEED = 8_000_001
_EMPTY_SEED = 8_000_003
_FEWEST = 50


@dataclass(frozen=True)
class ExportConfig:
    """Writes crop.onnx, finder.onnx, their weights and model.json."""

    crop: Path
    """weights.safetensors of a crop network."""
    finder: Path
    """weights.safetensors of a finder."""
    out: Path
    """Model folder."""
    target: str = "space-rider"
    side: int = 128
    """Pixels of the crop network's input."""
    finder_side: int = 256
    net: HeatmapNetConfig = field(default_factory=HeatmapNetConfig)
    """Of the crop network, as it was trained."""
    least_median_score: float | None = None
    """Median keypoint score below which an image shows no target; measured on frames without one when not given."""
    alignment: AlignConfig = field(default_factory=AlignConfig)
    """Scale, doubt and least share of edges are measured."""
    calibration: int = 300
    """Fresh ray-cast frames on which the covariances are scaled; a third as many show no target."""


def run(config: ExportConfig) -> None:
    """Entry of `proxnav train export`."""
    target = load_target(config.target)
    shape = replace(config.net, n_keypoints=len(target.keypoint_names))
    net = HeatmapNet(shape)
    load_weights(net, config.crop)
    finder = FinderNet(FinderConfig())
    load_weights(finder, config.finder)
    export(ReadKeypoints(net), ReadKeypoints.OUTPUTS, config.side, config.out, "crop")
    export(FindTarget(finder), ("probability",), config.finder_side, config.out, "finder")
    card = {
        "detector": "heatmap",
        "target": target.name,
        "keypoint_names": list(target.keypoint_names),
        "keypoints_m": target.keypoints_m.tolist(),
        "settings": {"crop_side": config.side, "finder_side": config.finder_side, "spread_scale": 1.0},
        "least_median_score": 0.0,
        "network": asdict(shape),
    }
    write_model_card(config.out, card)
    estimator = PoseEstimator.load(str(config.out))
    least = without_target(config, estimator) if config.least_median_score is None else config.least_median_score
    scale = calibrate(config, replace(estimator, least_median_score=least))
    card["settings"]["spread_scale"] = round(scale, 4)
    card["least_median_score"] = round(least, 4)
    card["alignment"] = _changed(config.alignment)
    if target.name not in GENERATED:
        save_target(target, config.out / "target")
    write_model_card(config.out, card)
    card["alignment"] = _changed(calibrate_alignment(config))
    write_model_card(config.out, card)
    print(f"{config.out}: covariances scaled by {scale:.3f} (standard deviation), least median score {least:.3f}")


def without_target(config: ExportConfig, estimator: PoseEstimator) -> float:
    """Just above the best median score that passes for a pose in frames of sky and Earth alone; 0 where none does.

    Consensus is no proof of a target: what tells it apart is how sure the keypoints are, and networks differ in that.
    """
    best, scenes = 0.0, draw_scenes(_preset(config), max(1, config.calibration // 3), _EMPTY_SEED)
    make = FrameJob(config.target, FrameConfig("raycast"))()
    with progress("frames without a target", len(scenes)) as done:
        for scene in scenes:
            image = make(replace(scene, t_cam_target_m=BEHIND_M)).image
            keypoints, result = estimator.observe(image, scene.camera)
            if result.T_cam_target is not None:
                best = max(best, keypoints.median_score)
            done()
    return min(best + 0.01, 0.99) if best > 0.0 else 0.0


def _preset(config: ExportConfig) -> Mission:
    return replace(load_mission("observation-10-100m"), target=config.target)


def calibrate(config: ExportConfig, estimator: PoseEstimator) -> float:
    """Factor on the claimed standard deviations that makes the mean NEES of poses from fresh frames that of 6 normals.

    Errors of neighbouring keypoints are alike, so that a pose is less certain than its keypoints one by one: the scale
    has to come from poses.
    """
    make, found = FrameJob(config.target, FrameConfig("raycast"))(), []
    with progress("calibrate", config.calibration) as done:
        for scene in draw_scenes(_preset(config), config.calibration, _CALIBRATION_SEED):
            result = estimator(make(scene).image, scene.camera)
            if result.T_cam_target is not None and result.covariance is not None:
                error = difference(result.T_cam_target, scene.T_cam_target)
                found.append(float(squared_mahalanobis(error, result.covariance)))
            done()
    if len(found) < _FEWEST:
        raise InputError(
            f"{len(found)} of {config.calibration} frames gave a pose, calibration needs {_FEWEST}: train on"
        )
    return float(np.sqrt(np.mean(np.minimum(found, np.quantile(found, KEPT))) / 6.0))


def calibrate_alignment(config: ExportConfig) -> AlignConfig:
    """How the exported model should lay outlines onto images, from its poses in fresh frames."""
    estimator = PoseEstimator.load(str(config.out))
    make, found = FrameJob(config.target, FrameConfig("raycast"))(), []
    with progress("calibrate the alignment", config.calibration) as done:
        for scene in draw_scenes(_preset(config), config.calibration, _CALIBRATION_SEED):
            aligned = estimator.alignment_of(make(scene).image, scene.camera)
            if aligned is not None:
                found.append((aligned, scene.T_cam_target))
            done()
    if len(found) < _FEWEST:
        raise InputError(f"{len(found)} of {config.calibration} frames gave a pose, calibration needs {_FEWEST}")
    return calibrated(config.alignment, Samples.of(found, estimator.alignment))


def _changed(config: AlignConfig) -> dict[str, Any]:
    """What differs from the defaults, as model.json keeps it."""
    values = asdict(config)
    rounded = {name: round(value, 3) if isinstance(value, float) else value for name, value in values.items()}
    return {name: value for name, value in rounded.items() if value != asdict(AlignConfig())[name]}
