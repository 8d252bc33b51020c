"""The crop network: one map of scores per keypoint, a map of its spread, and the target's mask.

Scores are classified over positions, not regressed to a mean: a nearly symmetric target gives two modes, and an average
of two modes is a point on neither.
"""

from typing import NamedTuple

from torch import Tensor, nn

from proxnav.detection.heatmap.config import HeatmapNetConfig
from proxnav.detection.heatmap.pyramid import Pyramid


class Maps(NamedTuple):
    """What the network says, at a quarter of the crop's resolution."""

    logits: Tensor
    """(b, n, h, w) score of each cell being the keypoint's; softmax over h and w gives the probability."""
    spread: Tensor
    """(b, 3n, h, w) of each keypoint and cell: log sigma_x, log sigma_y, atanh of the correlation [cells]."""
    mask: Tensor
    """(b, 1, h, w) logit of the cell showing the target."""


class HeatmapNet(nn.Module):
    """Grey crops (b, 1, H, W) in [0, 1] to `Maps`; H and W are multiples of 32."""

    def __init__(self, config: HeatmapNetConfig, n_keypoints: int) -> None:
        super().__init__()
        self.pyramid = Pyramid(config.trunk, config.width)
        self.logits = nn.Conv2d(config.width, n_keypoints, 1)
        self.spread = nn.Conv2d(config.width, 3 * n_keypoints, 1)
        self.mask = nn.Conv2d(config.width, 1, 1)
        for parameter in self.spread.parameters():
            nn.init.zeros_(parameter)  # starts at one cell of standard deviation, uncorrelated

    def forward(self, crops: Tensor) -> Maps:
        features = self.pyramid(crops)
        return Maps(self.logits(features), self.spread(features.detach()), self.mask(features))
