"""The endless stream of samples that processes draw ahead of the learner."""

from bisect import bisect_right
from collections.abc import Callable, Iterator
from functools import partial
from itertools import chain, count, islice

import numpy as np

from proxnav.cluster.local import in_order
from proxnav.detection.samples import SampleSource, TrainingSample
from proxnav.errors import InputError


def sample_source(
    job: Callable[[], Callable[[int], TrainingSample]], workers: int, repeats: int = 1, block: int = 512
) -> SampleSource:
    """The endless stream of a job's samples, drawn by `workers` processes ahead of the learner.

    Drawing costs more than learning: each block of samples passes `repeats` times before the next one, and the
    learner's augmentation makes each pass another view. The first blocks are smaller, so that learning begins
    soon. Sample i is the same for every stride that divides the blocks.
    """

    if workers < 1 or repeats < 1:
        raise InputError(f"workers and repeats must be at least 1, found {workers} and {repeats}")

    def stream(start: int, stride: int) -> Iterator[TrainingSample]:
        edge = partial(_edge, block=block)
        own = lambda number: range(edge(number) + start % stride, edge(number + 1), stride)  # noqa: E731
        number = bisect_right(range(start // repeats + 1), start // repeats, key=edge) - 1
        skip = (start - repeats * edge(number)) // stride
        drawn = in_order(job, chain.from_iterable(own(n) for n in count(number)), workers, ahead=block // stride)
        while True:
            kept = list(islice(drawn, len(own(number))))
            order = np.random.default_rng([number, start % stride])
            passes = [kept[i] for _ in range(repeats) for i in order.permutation(len(kept))]
            yield from passes[skip:]
            number += 1
            skip = 0

    return stream


def _edge(number: int, block: int) -> int:
    """First sample of a block; the samples of the first whole block come in smaller ones."""
    small = max(block // 8, min(block, 8))
    pieces = block // small
    return small * number if number <= pieces else block * (number - pieces + 1)
