"""Dimensions of the two networks and the settings that a model card keeps; needs no torch."""

from dataclasses import dataclass
from typing import Literal

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
