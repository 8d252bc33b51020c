"""Learning rates as functions of the step: nothing to save, and a longer run may resume a shorter one."""

import math
from collections.abc import Callable

Rate = Callable[[int], float]


def per_epoch(base: float, factor: float, steps_per_epoch: int) -> Rate:
    """base * factor^epoch, constant within an epoch: the seed study's schedule with 1e-3 and 0.98."""
    return lambda step: base * factor ** (step // steps_per_epoch)


def warm_up_then_cosine(base: float, steps: int, warm_up: int = 100, final: float = 0.01) -> Rate:
    """Linear from zero over `warm_up` steps, then half a cosine down to `final * base` at `steps`."""

    def rate(step: int) -> float:
        if step < warm_up:
            return base * (step + 1) / warm_up
        share = min(1.0, (step - warm_up) / max(1, steps - warm_up))
        return base * (final + (1 - final) * 0.5 * (1 + math.cos(math.pi * share)))

    return rate
