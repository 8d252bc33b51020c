"""The endless stream of samples that processes draw ahead of the learner."""

from collections.abc import Callable, Iterator
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
    learner's augmentation makes each pass another view. Sample i is the same for every stride that divides `block`.
    """

    if workers < 1 or repeats < 1:
        raise InputError(f"workers and repeats must be at least 1, found {workers} and {repeats}")

    def stream(start: int, stride: int) -> Iterator[TrainingSample]:
        own = lambda number: range(number * block + start % stride, (number + 1) * block, stride)  # noqa: E731
        number, skip = start // (repeats * block), (start % (repeats * block)) // stride
        drawn = in_order(job, chain.from_iterable(own(n) for n in count(number)), workers, ahead=block // stride)
        while True:
            kept = list(islice(drawn, block // stride))
            order = np.random.default_rng([number, start % stride])
            passes = [kept[i] for _ in range(repeats) for i in order.permutation(len(kept))]
            yield from passes[skip:]
            number += 1
            skip = 0

    return stream
