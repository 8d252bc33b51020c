"""One progress line for every slow command: done, rate, time left; plain text when the output is no terminal."""

import os
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

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
    """Lines on stderr, at most one every half minute and one at the end.

    The time left follows from the items since the last line: first ones compile kernels or start a renderer.
    """
    start = said = time.monotonic()
    done = told = 0

    def advance() -> None:
        nonlocal said, told, done
        done += 1
        now = time.monotonic()
        if done < total and now - said < _PLAIN_EVERY_S:
            return
        if done == total:
            text = f"in {now - start:.0f} s"
        elif told == 0:
            text = f"the first took {now - start:.0f} s" if done == 1 else f"after {now - start:.0f} s"
        else:
            each = max(now - said, 1e-9) / (done - told)
            text = f"{1.0 / each:.2f}/s, {(total - done) * each:.0f} s left"
        said, told = now, done
        print(f"{job}: {done}/{total}, {text}", file=sys.stderr)

    return advance


def say_when_compiling(*rooms: str) -> None:
    """A line on stderr for each room whose kernels were never compiled here: its first use is silent for a while."""
    for room in rooms:
        folder = Path(__file__).parents[1] / room
        if not os.environ.get("NUMBA_CACHE_DIR") and next(folder.rglob("*.nbi"), None) is None:
            takes = "once; this takes a minute or more"
            print(f"first use: compiling the kernels of {room}, {takes}", file=sys.stderr)
