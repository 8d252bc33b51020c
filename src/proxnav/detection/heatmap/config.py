"""Dimensions of the two networks, how they are trained, and the settings that a model card keeps; needs no torch."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from proxnav.detection.training.config import LoopConfig

Trunk = Literal["resnet10", "resnet18", "resnet34", "resnet50", "mobilenet"]


@dataclass(frozen=True)
class HeatmapNetConfig:
    """Size and shape of the crop network."""

    trunk: Trunk = "resnet18"
    """ResNet without its classifier."""
    width: int = 96
    """Channels of the top-down path."""


@dataclass(frozen=True)
class HeatmapSettings:
    """How the two trained networks are used."""

    crop_side: int = 256
    """Side of the crop network's input [px]."""
    finder_side: int = 256
    """Side of the finder's input [px]."""
    spread_scale: float = 1.0
    """Factor on the standard deviations of keypoints, from calibration on validation frames."""
    passes: int = 2
    """2 crops once more where the pose of the first crop puts the target."""
    turns: int = 1
    """4 reads a crop turned by quarters too and takes the surest look: for networks that learnt little roll."""


@dataclass(frozen=True)
class TrainHeatmapConfig:
    """How the crop network is trained."""

    net: HeatmapNetConfig = field(default_factory=HeatmapNetConfig)
    loop: LoopConfig = field(default_factory=lambda: LoopConfig(steps=8000, batch_size=32, log_every=50))
    rate: float = 1e-3
    start: Path | None = None
    """Weights (safetensors) to start from, such as those of a smaller side."""
    trunk: Path | None = None
    """Weights of another target's network, of which those that fit are taken: all but the keypoints' own."""


@dataclass(frozen=True)
class TrainFinderConfig:
    """How the finder is trained."""

    loop: LoopConfig = field(default_factory=lambda: LoopConfig(steps=1500, batch_size=16, log_every=50))
    rate: float = 1e-3
    start: Path | None = None
    """Weights (safetensors) to start from."""
