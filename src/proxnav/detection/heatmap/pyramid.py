"""A trunk with a top-down path: features of the whole crop's meaning at a quarter of its resolution.

T.-Y. Lin et al., "Feature Pyramid Networks for Object Detection", CVPR 2017.
"""

import torch
from torch import Tensor, nn

from proxnav.detection.heatmap.config import Trunk
from proxnav.detection.heatmap.trunks import build_trunk

STRIDE = 4
"""Input pixels per cell of the features."""


class Pyramid(nn.Module):
    """Grey images (b, 1, H, W) in [0, 1] to features (b, width, H/4, W/4); H and W are multiples of 32."""

    def __init__(self, trunk: Trunk, width: int) -> None:
        super().__init__()
        self.stem, self.stages, channels = build_trunk(trunk)
        self.lateral = nn.ModuleList([nn.Conv2d(c, width, 1) for c in channels])
        self.smooth = nn.ModuleList([_smooth(width) for _ in channels[:-1]])

    def forward(self, images: Tensor) -> Tensor:
        # The root makes photon noise even and lifts what lies in shadow.
        features = self.stem((images.sqrt() - 0.3) / 0.25)
        levels = []
        for stage in self.stages:
            features = stage(features)
            levels.append(features)
        merged = self.lateral[-1](levels[-1])
        for level in reversed(range(len(levels) - 1)):
            upsampled = nn.functional.interpolate(merged, scale_factor=2.0, mode="nearest")
            merged = self.smooth[level](self.lateral[level](levels[level]) + upsampled)
        return merged


def as_channels_last(net: nn.Module) -> nn.Module:
    """The same network in the memory layout that CPU convolutions prefer."""
    return net.to(memory_format=torch.channels_last)  # pyright: ignore[reportCallIssue]


def _smooth(width: int) -> nn.Module:
    return nn.Sequential(
        nn.Conv2d(width, width, 3, padding=1, bias=False), nn.BatchNorm2d(width), nn.ReLU(inplace=True)
    )
