"""What a detector brings to training, and what comes out."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import torch
from torch import Tensor, nn

from proxnav.detection.training.feed import Collate
from proxnav.detection.training.rates import Rate

Validate = Callable[[nn.Module], float]
"""Score of the averaged model in eval mode, lower is better: the mean E_C of a validation set, for example."""


@dataclass(frozen=True, slots=True)
class Learner:
    """A network and how it learns."""

    model: nn.Module
    optimizer: torch.optim.Optimizer
    rate: Rate
    """Learning rate at a step; a parameter group's `scale`, where it has one, multiplies it."""
    collate: Collate
    """(samples, step, rng) -> batch of tensors, lists and dicts."""
    loss: Callable[[nn.Module, Any], dict[str, Tensor]]
    """(model, batch) -> named terms, whose sum is minimised; calls the model by its forward alone."""
    notes: dict[str, Any] = field(default_factory=dict)
    """Plain values that describe the network; a checkpoint resumes only where they agree."""


@dataclass(frozen=True, slots=True)
class TrainingResult:
    """How a run ended."""

    reason: Literal["finished", "early_stop", "time"]
    model: nn.Module
    """The averaged weights, those of the best validation where there were any; eval mode, on the CPU."""
    steps: int
    samples: int
    """Images drawn, over all processes."""
    skipped: int
    """Steps left out because the loss or its gradient was not finite."""
    best_score: float
    """Best validation score; NaN without validation."""
    weights: Path
    """`weights.safetensors` of `model`."""
