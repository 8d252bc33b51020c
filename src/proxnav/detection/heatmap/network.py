"""The crop network: a ResNet trunk, a top-down path to stride 4, one map of scores per keypoint.

Scores are classified over positions, not regressed to a mean: a nearly symmetric target gives two modes, and an average
of two modes is a point on neither. The top-down path follows T.-Y. Lin et al., "Feature Pyramid Networks", CVPR 2017.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import torch
import torchvision
from torch import Tensor, nn

STRIDE = 4
"""Input pixels per cell of the output maps."""


@dataclass(frozen=True)
class HeatmapNetConfig:
    """Size and shape of the crop network."""

    n_keypoints: int = 24
    trunk: Literal["resnet18", "resnet34", "resnet50"] = "resnet18"
    """ResNet without its classifier."""
    width: int = 96
    """Channels of the top-down path."""


class Maps(NamedTuple):
    """What the network says, at stride 4."""

    logits: Tensor
    """(b, n, h, w) score of each cell being the keypoint's; softmax over h and w gives the probability."""
    spread: Tensor
    """(b, 3n, h, w) of each keypoint and cell: log sigma_x, log sigma_y, atanh of the correlation [cells]."""
    mask: Tensor
    """(b, 1, h, w) logit of the cell showing the target."""


class HeatmapNet(nn.Module):
    """Grey crop (b, 1, H, W) in [0, 1] to `Maps`; H and W are multiples of 32."""

    def __init__(self, config: HeatmapNetConfig) -> None:
        super().__init__()
        trunk = getattr(torchvision.models, config.trunk)(weights=None)
        channels = [
            block[-1].bn2.num_features if config.trunk != "resnet50" else block[-1].bn3.num_features
            for block in (trunk.layer1, trunk.layer2, trunk.layer3, trunk.layer4)
        ]
        trunk.conv1 = nn.Conv2d(1, 64, kernel_size=7, stride=2, padding=3, bias=False)
        self.stem = nn.Sequential(trunk.conv1, trunk.bn1, trunk.relu, trunk.maxpool)
        self.stages = nn.ModuleList([trunk.layer1, trunk.layer2, trunk.layer3, trunk.layer4])
        self.lateral = nn.ModuleList([nn.Conv2d(c, config.width, 1) for c in channels])
        self.smooth = nn.ModuleList([_smooth(config.width) for _ in channels[:-1]])
        self.logits = nn.Conv2d(config.width, config.n_keypoints, 1)
        self.spread = nn.Conv2d(config.width, 3 * config.n_keypoints, 1)
        self.mask = nn.Conv2d(config.width, 1, 1)
        nn.init.zeros_(self.spread.weight)
        nn.init.zeros_(self.spread.bias)  # starts at one cell of standard deviation, uncorrelated

    def forward(self, crops: Tensor) -> Maps:
        features = self.stem((crops - 0.25) / 0.25)
        pyramid = []
        for stage in self.stages:
            features = stage(features)
            pyramid.append(features)
        merged = self.lateral[-1](pyramid[-1])
        for level in reversed(range(len(pyramid) - 1)):
            upsampled = nn.functional.interpolate(merged, scale_factor=2.0, mode="nearest")
            merged = self.smooth[level](self.lateral[level](pyramid[level]) + upsampled)
        return Maps(self.logits(merged), self.spread(merged.detach()), self.mask(merged))


def _smooth(width: int) -> nn.Module:
    return nn.Sequential(
        nn.Conv2d(width, width, 3, padding=1, bias=False), nn.BatchNorm2d(width), nn.ReLU(inplace=True)
    )


def count_parameters(net: nn.Module) -> int:
    """Trainable numbers of a network."""
    return sum(parameter.numel() for parameter in net.parameters())


def as_channels_last(net: nn.Module) -> nn.Module:
    """The same network in the memory layout that CPU convolutions prefer."""
    return net.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]
