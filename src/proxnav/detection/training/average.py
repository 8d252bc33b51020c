"""The running average of weights, which scores better than the weights of any single step."""

from copy import deepcopy

import torch
from torch import nn


def averaged_copy(model: nn.Module) -> nn.Module:
    """A copy of the model that `update_average` moves and no optimiser touches."""
    return deepcopy(model).requires_grad_(False).eval()


@torch.no_grad()
def update_average(average: nn.Module, model: nn.Module, step: int, decay: float) -> None:
    """average <- d average + (1 - d) model, with d = min(decay, (1 + step) / (10 + step)) so that it starts fast.

    Batch statistics are averaged as the weights are; counters are copied.
    """
    share = 1.0 - min(decay, (1 + step) / (10 + step))
    state = model.state_dict()
    for name, slow in average.state_dict().items():
        if slow.is_floating_point():
            slow.lerp_(state[name], share)
        else:
            slow.copy_(state[name])
