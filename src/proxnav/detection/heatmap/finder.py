"""The finder network: where in the full frame is the target, at low resolution."""

from torch import Tensor, nn

from proxnav.detection.heatmap.config import Trunk
from proxnav.detection.heatmap.pyramid import Pyramid

TRUNK: Trunk = "resnet10"
WIDTH = 48
"""Channels of the top-down path."""


class FinderNet(nn.Module):
    """Grey frames (b, 1, H, W) in [0, 1] to logits (b, 1, H/4, W/4) of each cell showing the target."""

    def __init__(self, width: int = WIDTH) -> None:
        super().__init__()
        self.pyramid = Pyramid(TRUNK, width)
        self.mask = nn.Conv2d(width, 1, 1)

    def forward(self, frames: Tensor) -> Tensor:
        return self.mask(self.pyramid(frames))
