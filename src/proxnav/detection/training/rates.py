"""Learning rates as functions of the step and the share of the training that is done: nothing to save."""

import math
from collections.abc import Callable

Rate = Callable[[int, float], float]
"""Rate at a step, of a training of which a share in [0, 1], by steps or by time, is done."""


def per_epoch(base: float, factor: float, steps_per_epoch: int) -> Rate:
    """base * factor^epoch, constant within an epoch: the seed study's schedule with 1e-3 and 0.98."""
    return lambda step, share: base * factor ** (step // steps_per_epoch)


def warm_up_then_cosine(base: float, warm_up: int = 100, final: float = 0.01) -> Rate:
    """Linear from zero over `warm_up` steps, times half a cosine from 1 to `final` over the whole training.

    >>> rate = warm_up_then_cosine(1.0, warm_up=2)
    >>> rate(0, 0.0), rate(9, 0.0), round(rate(9, 1.0), 6)
    (0.5, 1.0, 0.01)
    """

    def rate(step: int, share: float) -> float:
        cosine = 0.5 * (1.0 + math.cos(math.pi * min(1.0, share)))
        return base * min(1.0, (step + 1) / warm_up) * (final + (1.0 - final) * cosine)

    return rate
