"""`proxnav train export`: trained networks as a model folder that runs without torch, its covariances calibrated."""

from dataclasses import asdict, dataclass, field, replace
from pathlib import Path

import numpy as np
import tyro

from proxnav import presets
from proxnav.commands.progress import progress
from proxnav.crops import CropConfig, CropJob
from proxnav.detection.heatmap.export import FindTarget, ReadKeypoints, export
from proxnav.detection.heatmap.finder import FinderConfig, FinderNet
from proxnav.detection.heatmap.network import HeatmapNet, HeatmapNetConfig
from proxnav.detection.samples import TrainingSample
from proxnav.detection.sessions import Session, open_session
from proxnav.detection.training.files import load_weights
from proxnav.estimator import write_model_card
from proxnav.targets.loading import load_target

_CALIBRATION_SEED = 8_000_001
_MEDIAN_CHI2_2 = 2.0 * np.log(2.0)  # of the squared normalised error in two dimensions
_WORST = 25.0  # squared normalised errors above this are confusions, which no scale should cover


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
    calibration: int = 400
    """Fresh ray-cast crops on which the covariances are scaled."""


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
    scale = calibrate(config)
    settings = {"crop_side": config.side, "finder_side": config.finder_side, "spread_scale": round(scale, 4)}
    write_model_card(
        config.out,
        {
            "detector": "heatmap",
            "target": target.name,
            "keypoint_names": list(target.keypoint_names),
            "keypoints_m": target.keypoints_m.tolist(),
            "settings": settings,
            "network": asdict(shape),
        },
    )
    print(f"{config.out}: covariances scaled by {scale:.3f} (standard deviation)")


def calibrate(config: ExportConfig) -> float:
    """Factor on the claimed standard deviations that makes the median squared normalised error that of two normals."""
    read = open_session(config.out / "crop.onnx")
    job = CropConfig(config.target, config.side, scenes=presets.OBSERVATION, seed=_CALIBRATION_SEED)
    make, found = CropJob(job)(), []
    with progress("calibrate", config.calibration) as done:
        for index in range(config.calibration):
            found.append(_normalised(read, make(index)))
            done()
    squared = np.concatenate(found)
    return float(np.sqrt(np.median(squared[squared < _WORST]) / _MEDIAN_CHI2_2))


def _normalised(read: Session, sample: TrainingSample) -> np.ndarray:
    """Squared normalised errors of the keypoints inside a crop."""
    points, _, covariances, _ = read(sample.image[None])
    error = points[0] - sample.keypoints_px
    squared = np.einsum("ni,nij,nj->n", error, np.linalg.inv(covariances[0].astype(np.float64)), error)
    return squared[(sample.visibility > 0) & np.isfinite(squared)]
