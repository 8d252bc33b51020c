"""One progress line for every slow command: done, rate, time left; plain text when the output is no terminal."""

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

_PLAIN_EVERY_S = 30.0


@contextmanager
def progress(job: str, total: int) -> Iterator[Callable[[], None]]:
    """Yields a function to call after each item."""
    if sys.stderr.isatty():
        with _bar() as bar:
            task = bar.add_task(job, total=total, rate="")
            start = time.monotonic()

            def advance() -> None:
                bar.advance(task)
                done = bar.tasks[task].completed
                bar.update(task, rate=f"{done / max(time.monotonic() - start, 1e-9):.2f}/s")

            yield advance
        return
    yield _plain(job, total)


def _bar() -> Progress:
    return Progress(
        TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"),
        TimeElapsedColumn(), TextColumn("left"), TimeRemainingColumn(), console=Console(stderr=True),
    )  # fmt: skip


def _plain(job: str, total: int) -> Callable[[], None]:
    """Lines on stderr, at most one every half minute and one at the end."""
    start, said, done = time.monotonic(), time.monotonic(), 0

    def advance() -> None:
        nonlocal said, done
        done += 1
        now = time.monotonic()
        if done < total and now - said < _PLAIN_EVERY_S:
            return
        said = now
        left = (total - done) * (now - start) / done
        print(f"{job}: {done}/{total}, {done / max(now - start, 1e-9):.2f}/s, {left:.0f} s left", file=sys.stderr)

    return advance
