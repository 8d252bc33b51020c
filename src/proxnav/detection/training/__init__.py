"""Training, whatever the network: exact resume, averaged weights, learning curve, early stop."""

from proxnav.detection.training.config import Learner, LoopConfig, TrainingResult, Validate
from proxnav.detection.training.loop import train
from proxnav.detection.training.rates import Rate, per_epoch, warm_up_then_cosine

__all__ = [
    "Learner",
    "LoopConfig",
    "Rate",
    "TrainingResult",
    "Validate",
    "per_epoch",
    "train",
    "warm_up_then_cosine",
]
