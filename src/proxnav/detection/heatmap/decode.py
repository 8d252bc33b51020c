"""From maps of scores to sub-pixel keypoints: the mean of the probability in a window round its peak.

The window keeps other modes out; the mean inside it is the truth for a Gaussian that the window holds (a local form of
the soft-argmax of X. Sun et al., "Integral Human Pose Regression", ECCV 2018). Written in tensor operations that export
to ONNX, so that every runtime decodes alike.
"""

import torch
from torch import Tensor

RADIUS = 3
"""Half width of the window [cells]: three standard deviations of the training target."""


def decode(logits: Tensor) -> tuple[Tensor, Tensor]:
    """Points (b, n, 2) [cells, corner origin] and scores (b, n): the probability that lies in the window."""
    b, n, height, width = logits.shape
    p = logits.float().flatten(2).softmax(dim=-1)
    peak = p.argmax(dim=-1)
    row, column = peak // width, peak % width
    x = torch.arange(width, device=logits.device)
    y = torch.arange(height, device=logits.device)
    near_x = ((x - column[..., None]).abs() <= RADIUS).float()
    near_y = ((y - row[..., None]).abs() <= RADIUS).float()
    window = p.view(b, n, height, width) * near_y[..., :, None] * near_x[..., None, :]
    score = window.sum(dim=(-2, -1))
    mean_x = (window.sum(dim=-2) * (x + 0.5)).sum(dim=-1) / score
    mean_y = (window.sum(dim=-1) * (y + 0.5)).sum(dim=-1) / score
    return torch.stack([mean_x, mean_y], dim=-1), score


def sample_spread(spread: Tensor, points: Tensor) -> Tensor:
    """(b, n, 3) log sigma_x, log sigma_y [cells] and correlation, read at the cell of each point."""
    b, n, _ = points.shape
    height, width = spread.shape[-2:]
    column = points[..., 0].floor().long().clamp(0, width - 1)
    row = points[..., 1].floor().long().clamp(0, height - 1)
    index = (row * width + column)[:, :, None, None].expand(b, n, 3, 1)
    values = spread.float().view(b, n, 3, height * width).gather(3, index)[..., 0]
    log_sigma = values[..., :2].clamp(-5.0, 4.0)
    return torch.cat([log_sigma, 0.95 * torch.tanh(values[..., 2:])], dim=-1)


def covariances(spread: Tensor) -> Tensor:
    """(b, n, 2, 2) [cells^2] from `sample_spread`."""
    log_x, log_y, rho = spread.unbind(dim=-1)
    xx, yy = torch.exp(2.0 * log_x), torch.exp(2.0 * log_y)
    xy = rho * torch.exp(log_x + log_y)
    return torch.stack([torch.stack([xx, xy], dim=-1), torch.stack([xy, yy], dim=-1)], dim=-2)
