"""`proxnav train export`: trained networks as a model folder that runs without torch, its covariances calibrated."""

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
import tyro

from proxnav import presets
from proxnav.commands.progress import progress
from proxnav.detection.heatmap.export import FindTarget, ReadKeypoints, export
from proxnav.detection.heatmap.finder import FinderConfig, FinderNet
from proxnav.detection.heatmap.network import HeatmapNet, HeatmapNetConfig
from proxnav.detection.training.files import load_weights
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator, write_model_card
from proxnav.evaluation.consistency import nees
from proxnav.evaluation.pairing import difference
from proxnav.frames import FrameConfig, FrameJob
from proxnav.pipeline import draw_scenes
from proxnav.targets.loading import load_target

_CALIBRATION_SEED = 8_000_001
_FEWEST = 50
_KEPT = 0.98  # beyond this quantile an error is a confusion, which no scale should cover: it counts as the quantile


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
    least_median_score: float = 0.92
    """Median keypoint score below which an image shows no target; docs/heatmap.md says how it was chosen."""
    calibration: int = 300
    """Fresh ray-cast frames on which the covariances are scaled."""


def main(argv: list[str]) -> None:
    """Entry of `proxnav train export`."""
    config = tyro.cli(ExportConfig, args=argv, prog="proxnav train export")
    target = load_target(config.target)
    shape = replace(config.net, n_keypoints=len(target.keypoint_names))
    net = HeatmapNet(shape)
    load_weights(net, config.crop)
    finder = FinderNet(FinderConfig())
    load_weights(finder, config.finder)
    outputs = ("points", "scores", "covariances", "shown")
    export(ReadKeypoints(net), outputs, config.side, config.out, "crop")
    export(FindTarget(finder), ("probability",), config.finder_side, config.out, "finder")
    card = {
        "detector": "heatmap",
        "target": target.name,
        "keypoint_names": list(target.keypoint_names),
        "keypoints_m": target.keypoints_m.tolist(),
        "settings": {"crop_side": config.side, "finder_side": config.finder_side, "spread_scale": 1.0},
        "least_median_score": config.least_median_score,
        "network": asdict(shape),
    }
    write_model_card(config.out, card)
    scale = calibrate(config)
    card["settings"]["spread_scale"] = round(scale, 4)
    write_model_card(config.out, card)
    print(f"{config.out}: covariances scaled by {scale:.3f} (standard deviation)")


def calibrate(config: ExportConfig) -> float:
    """Factor on the claimed standard deviations that makes the mean NEES of poses from fresh frames that of 6 normals.

    Errors of neighbouring keypoints are alike, so that a pose is less certain than its keypoints one by one: the scale
    has to come from poses.
    """
    estimator = PoseEstimator.load(str(config.out))
    preset = replace(presets.preset("observation-10-100m"), target=config.target)
    make, found = FrameJob(config.target, FrameConfig("raycast"))(), []
    with progress("calibrate", config.calibration) as done:
        for scene in draw_scenes(preset, config.calibration, _CALIBRATION_SEED):
            result = estimator(make(scene).image, scene.camera)
            if result.T_cam_target is not None and result.covariance is not None:
                found.append(nees(difference(result.T_cam_target, scene.T_cam_target), result.covariance))
            done()
    if len(found) < _FEWEST:
        raise InputError(
            f"{len(found)} of {config.calibration} frames gave a pose, calibration needs {_FEWEST}: train on"
        )
    return float(np.sqrt(np.mean(np.minimum(found, np.quantile(found, _KEPT))) / 6.0))
