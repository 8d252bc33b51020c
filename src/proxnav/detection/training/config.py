"""What a training run is told, what a detector brings to it, and what comes out."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import torch
from torch import Tensor, nn

from proxnav.detection.training.feed import Collate
from proxnav.detection.training.precision import Precision
from proxnav.detection.training.rates import Rate

Validate = Callable[[nn.Module], float]
"""Score of the averaged model in eval mode, lower is better: the mean E_C of a validation set, for example."""

SEED = 0
"""Seed of the weights' start, of augmentation and of dropout; the samples have seeds of their own."""


@dataclass(frozen=True)
class LoopConfig:
    """How to train, whatever the network."""

    steps: int = 1000
    """Optimiser steps in all. A finished run resumes when this grows."""
    batch_size: int = 8
    """Images in one pass through the network, in each process."""
    accumulate: int = 1
    """Passes whose gradients are averaged into one step."""
    average_decay: float = 0.998
    """Decay of the running average of weights, per step."""
    precision: Precision = "auto"
    """auto: bf16-mixed where the hardware multiplies it."""
    accelerator: Literal["auto", "cpu", "cuda", "mps"] = "auto"
    devices: int = 1
    """Processes, one for each accelerator; for more than one start the command under torchrun."""
    deterministic: bool = False
    """Only algorithms that give the same bits every time."""
    log_every: int = 20
    """Steps between rows of the learning curve."""
    save_every: int = 500
    """Steps between checkpoints."""
    validate_every: int = 0
    """Steps between validations; 0 leaves them out."""
    patience: int = 0
    """Validations without a better score before the run stops early; 0 never stops."""
    minutes: float = 0.0
    """Stop, resumable, after so long; 0 is no limit."""


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
