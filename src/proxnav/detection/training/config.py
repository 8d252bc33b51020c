"""What a training run is told, whatever the network; needs no torch."""

from dataclasses import dataclass
from typing import Literal

Precision = Literal["auto", "32-true", "bf16-mixed"]
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
    hours: float = 0.0
    """Time that the training has in all its parts together, by whose end the learning rate has fallen; 0 counts steps
    alone."""
