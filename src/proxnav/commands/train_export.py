"""`proxnav train export`: trained networks as a model folder that runs without torch, its covariances calibrated."""

from dataclasses import dataclass, field
from pathlib import Path

from proxnav.cli.options import MissionOptions
from proxnav.detection.heatmap.config import HeatmapNetConfig


@dataclass(frozen=True)
class ExportConfig(MissionOptions):
    """Writes crop.onnx, finder.onnx, their weights and model.json."""

    crop: Path
    """weights.safetensors of a crop network."""
    finder: Path
    """weights.safetensors of a finder."""
    out: Path
    """Model folder."""
    side: int = 128
    """Pixels of the crop network's input."""
    finder_side: int = 256
    net: HeatmapNetConfig = field(default_factory=HeatmapNetConfig)
    """Dimensions of the crop network, as it was trained."""
    least_median_score: float | None = None
    """Median keypoint score below which an image shows no target; measured on frames without one when not given."""
    calibration: int = 300
    """Fresh ray-cast frames on which the covariances are scaled; a third as many show no target."""
    trust: int = 30
    """Fresh frames under each of some twenty conditions on which trust is calibrated; 0 leaves it out."""


def run(config: ExportConfig) -> None:
    """Exports and calibrates."""
    from proxnav.cli.progress import progress
    from proxnav.detection.heatmap.config import HeatmapSettings
    from proxnav.learning.heatmap_export import export_heatmap_model

    settings = HeatmapSettings(config.side, config.finder_side)
    card = export_heatmap_model(
        config.crop, config.finder, config.out, config.read_mission(), config.net, settings, config.calibration,
        config.least_median_score, progress, config.trust,
    )  # fmt: skip
    assert isinstance(card.settings, HeatmapSettings)
    print(
        f"{config.out}: covariances scaled by {card.settings.spread_scale:.3f} (standard deviation), "
        f"least median score {card.least_median_score:.3f}"
    )
