"""Jobs over the cores of this machine: each process builds its tool once, a process that dies is replaced."""

import multiprocessing
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from typing import Any, TypeVar

from proxnav.cluster.threads import one_thread_each

Item = TypeVar("Item")
Result = TypeVar("Result")

_RESTARTS = 5
_AHEAD = 2
"""Items queued per worker: enough to keep it busy, few enough to stop soon."""


def run_jobs(
    make_job: Callable[[], Callable[[Item], Result]], items: Sequence[Item], workers: int = 1
) -> Iterator[tuple[Item, Result]]:
    """(item, result) as they finish. `make_job` builds the job once per process; both it and the items are pickled.

    With one worker everything runs in this process. A worker that dies (out of memory, killed) is replaced and its
    items run again, at most `_RESTARTS` times; an exception in a job ends the run with that exception.
    """
    if workers <= 1:
        job = make_job()
        for item in items:
            yield item, job(item)
        return
    yield from run_in_processes(make_job, items, workers)


def run_in_processes(
    make_job: Callable[[], Callable[[Item], Result]], items: Sequence[Item], workers: int
) -> Iterator[tuple[Item, Result]]:
    """As `run_jobs`, with a process of its own for a single worker too."""
    waiting, restarts = list(reversed(items)), 0
    while waiting:
        running: dict[Future[Result], Item] = {}
        try:
            yield from _drain(make_job, waiting, running, workers)
        except BrokenProcessPool:
            restarts += 1
            if restarts > _RESTARTS:
                raise
            waiting.extend(running.values())


def in_order(
    make_job: Callable[[], Callable[[Item], Result]], items: Iterator[Item], workers: int, ahead: int = 64
) -> Iterator[Result]:
    """Results in the order of an endless stream of items, up to `ahead` of them computed before they are asked for.

    The workers yield to the process that they feed: with the cores shared evenly, a learner's threads would wait for
    each other at every layer.
    """
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, context, initializer=_build_politely, initargs=(make_job,))
    pending: deque[Future[Result]] = deque()
    try:
        for item in items:
            pending.append(_submit(pool, item))
            if len(pending) > ahead:
                yield pending.popleft().result()
        while pending:
            yield pending.popleft().result()
    finally:
        pool.shutdown(wait=False, cancel_futures=True)


def _drain(
    make_job: Callable[[], Callable[[Any], Any]], waiting: list[Any], running: dict[Future[Any], Any], workers: int
) -> Iterator[tuple[Any, Any]]:
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(workers, context, initializer=_build, initargs=(make_job,))
    try:
        while waiting or running:
            while waiting and len(running) < _AHEAD * workers:
                running[_submit(pool, waiting[-1])] = waiting[-1]
                waiting.pop()
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                result = future.result()
                yield running.pop(future), result
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


_job: Callable[[Any], Any] | None = None  # one per worker process, set by its initialiser


def _build(make_job: Callable[[], Callable[[Any], Any]]) -> None:
    """Builds the job; what goes wrong is said by its first item, since a pool only says that it broke.

    Ctrl-C reaches every process of a terminal: workers leave it to the one that they work for, which may want to save.
    """
    global _job
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_leave_with_parent, daemon=True).start()
    try:
        _job = make_job()
    except Exception as error:
        failure = error

        def refuse(item: Any) -> Any:
            raise failure

        _job = refuse


def _leave_with_parent() -> None:
    """A worker holds both ends of its queue: of a process that was killed it would hear nothing, and wait for ever."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    parent.join()
    os._exit(1)


def _build_politely(make_job: Callable[[], Callable[[Any], Any]]) -> None:
    if hasattr(os, "nice"):
        os.nice(10)
    _build(make_job)


def _submit(pool: ProcessPoolExecutor, item: Any) -> Future[Any]:
    """A pool starts its processes as items come in."""
    with one_thread_each():
        return pool.submit(_call, item)


def _call(item: Any) -> Any:
    assert _job is not None
    return _job(item)
