"""What the crop network is trained to: the likelihood of the true keypoints under its maps.

Position: cross-entropy between the softmax over all cells and a Gaussian round the truth (bilinear at sigma 0), so that
modes stay modes. Covariance: Gaussian negative log-likelihood of the decoded point's error, with the decoded point held
fixed, so that doubt never pulls on the position. Mask: binary cross-entropy, an auxiliary task that speeds convergence.
"""

import torch
from torch import Tensor

from proxnav.detection.heatmap.decode import decode, sample_spread
from proxnav.detection.heatmap.network import Maps

SIGMA_CELLS = 1.0
"""Width of the target Gaussian."""
HIDDEN_WEIGHT = 0.5
"""Weight of keypoints that the target itself hides; visible ones weigh 1."""
SPREAD_WEIGHT = 0.1
"""Weight of the covariance's term; position and mask weigh 1."""


def keypoint_loss(maps: Maps, keypoints_cells: Tensor, visibility: Tensor, mask: Tensor) -> dict[str, Tensor]:
    """Weighted terms, whose sum is the loss.

    `keypoints_cells` (b, n, 2) in cells, corner origin; `visibility` (b, n) as COCO; `mask` (b, h, w) in [0, 1]. Points
    outside the maps carry no weight: the crop cannot say where they are.
    """
    height, width = maps.logits.shape[-2:]
    limit = torch.tensor([width, height], dtype=keypoints_cells.dtype, device=keypoints_cells.device)
    inside = ((keypoints_cells >= 0) & (keypoints_cells < limit)).all(dim=-1)
    weight = inside * torch.where(visibility == 2, 1.0, HIDDEN_WEIGHT)
    log_p = maps.logits.float().flatten(2).log_softmax(dim=-1)
    wanted = _gaussian(keypoints_cells, height, width, SIGMA_CELLS).flatten(2)
    position = _mean(-(wanted * log_p).sum(dim=-1), weight)
    spread = _mean(_spread_nll(maps, keypoints_cells), weight)
    shown = torch.nn.functional.binary_cross_entropy_with_logits(maps.mask.float()[:, 0], mask)
    return {"position": position, "spread": SPREAD_WEIGHT * spread, "mask": shown}


def _gaussian(points: Tensor, height: int, width: int, sigma: float) -> Tensor:
    """(b, n, h, w) normalised Gaussians about `points`, evaluated at cell centres."""
    x = torch.arange(width, device=points.device) + 0.5
    y = torch.arange(height, device=points.device) + 0.5
    gx = torch.exp(-0.5 * ((x - points[..., :1]) / sigma) ** 2)
    gy = torch.exp(-0.5 * ((y - points[..., 1:]) / sigma) ** 2)
    maps = gy[..., :, None] * gx[..., None, :]
    return maps / maps.sum(dim=(-2, -1), keepdim=True).clamp_min(1e-12)


def _spread_nll(maps: Maps, keypoints: Tensor) -> Tensor:
    """Negative log-likelihood (b, n) of the truth under N(decoded, covariance); errors beyond 4 cells count as 4."""
    with torch.no_grad():
        points, _ = decode(maps.logits)
        error = (keypoints - points).clamp(-4.0, 4.0)
    log_x, log_y, rho = sample_spread(maps.spread, points).unbind(dim=-1)
    zx, zy = error[..., 0] * torch.exp(-log_x), error[..., 1] * torch.exp(-log_y)
    q = 1.0 - rho * rho
    return log_x + log_y + 0.5 * torch.log(q) + 0.5 * (zx * zx - 2.0 * rho * zx * zy + zy * zy) / q


def _mean(values: Tensor, weight: Tensor) -> Tensor:
    return (values * weight).sum() / weight.sum().clamp_min(1.0)
