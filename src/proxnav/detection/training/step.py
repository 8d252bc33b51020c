"""One step of the optimiser, or none when the loss is not finite."""

from collections.abc import Callable
from typing import Any

import torch
from lightning_fabric import Fabric
from torch import Tensor, nn


def take_step(
    fabric: Fabric,
    model: nn.Module,
    optimizer: Any,
    loss: Callable[[nn.Module, Any], dict[str, Tensor]],
    parts: list[Any],
    clip_norm: float,
) -> dict[str, Tensor] | None:
    """Moves the weights by the mean gradient over `parts` and returns the mean loss terms.

    None, and nothing has changed, when the loss or its gradient is not finite in any process: an update would poison
    the weights and batch statistics for good.
    """
    statistics = [buffer.clone() for buffer in model.buffers()]
    terms = _accumulate(fabric, model, loss, parts)
    norm = fabric.clip_gradients(model, optimizer, max_norm=clip_norm, error_if_nonfinite=False)
    good = torch.isfinite(terms["loss"]) & torch.isfinite(torch.as_tensor(norm, device=terms["loss"].device))
    good = fabric.all_reduce(good.float(), reduce_op="mean") == 1.0
    if good:
        optimizer.step()
    else:
        with torch.no_grad():
            for buffer, before in zip(model.buffers(), statistics, strict=True):
                buffer.copy_(before)
    optimizer.zero_grad(set_to_none=True)
    return terms if good else None


def _accumulate(
    fabric: Fabric, model: nn.Module, loss: Callable[[nn.Module, Any], dict[str, Tensor]], parts: list[Any]
) -> dict[str, Tensor]:
    means: dict[str, Tensor] = {}
    for index, batch in enumerate(parts):
        with fabric.no_backward_sync(model, enabled=index < len(parts) - 1):  # type: ignore[arg-type]
            terms = loss(model, batch)
            total = torch.stack([term.float() for term in terms.values()]).sum()
            fabric.backward(total / len(parts))
        for name, value in {"loss": total, **terms}.items():
            means[name] = means.get(name, 0.0) + value.detach().float() / len(parts)
    return means
