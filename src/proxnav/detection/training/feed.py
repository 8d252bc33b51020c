"""Batches made one step ahead of the learner, in an order that depends on the step alone."""

import queue
import threading
from collections.abc import Callable, Generator, Iterator
from itertools import count, islice
from typing import Any, TypeVar

import numpy as np

from proxnav.detection.samples import SampleSource, TrainingSample
from proxnav.errors import InputError

Item = TypeVar("Item")
Collate = Callable[[list[TrainingSample], int, np.random.Generator], Any]
"""`collate(samples, step, rng)` makes the batch of a step; all its chance comes from `rng`."""


def batches(
    source: SampleSource, collate: Collate, batch_size: int, parts: int, seed: int, *, step: int, rank: int, world: int
) -> Iterator[list[Any]]:
    """From `step` on, the `parts` batches of each step for process `rank` of `world`."""
    stream = source(step * parts * batch_size * world + rank, world)
    for current in count(step):
        yield [
            collate(_take(stream, batch_size), current, np.random.default_rng([seed, current, part, rank]))
            for part in range(parts)
        ]


def _take(stream: Iterator[TrainingSample], n: int) -> list[TrainingSample]:
    samples = list(islice(stream, n))
    if len(samples) < n:
        raise InputError("the stream of training samples ended: a source must go on for ever (see `shuffled`)")
    return samples


def ahead(
    items: Iterator[Item], cancelled: Callable[[], bool] = lambda: False, depth: int = 2
) -> Generator[Item, None, None]:
    """The same items, drawn by a thread that stays up to `depth` items ahead; its exception is raised here.

    They end early where `cancelled` says so while there is nothing to give.
    """
    ready: queue.Queue[tuple[Item | None, BaseException | None]] = queue.Queue(depth)
    closed = threading.Event()

    def put(entry: tuple[Item | None, BaseException | None]) -> bool:
        while not closed.is_set():
            try:
                ready.put(entry, timeout=0.1)
                return True
            except queue.Full:
                continue
        return False

    def draw() -> None:
        try:
            for item in items:
                if not put((item, None)):
                    return
        except BaseException as error:  # handed to the reader, who raises it
            put((None, error))
        finally:
            # A source may hold processes that draw: they end here, not when the interpreter waits for them.
            getattr(items, "close", lambda: None)()

    worker = threading.Thread(target=draw, daemon=True, name="batches")
    worker.start()
    try:
        while True:
            try:
                item, error = ready.get(timeout=0.2)
            except queue.Empty:
                if cancelled():
                    return
                continue
            if error is not None:
                raise error
            yield item  # type: ignore[misc]
    finally:
        closed.set()
        worker.join(timeout=0.0 if cancelled() else 10.0)  # it may be waiting for a sample; it is a daemon
