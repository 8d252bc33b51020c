"""How fast a run goes and how long it waits for data, shown while it runs."""

import sys
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from torch import Tensor

_BAR = 1000
"""Steps of the bar."""
LINE_EVERY_S = 30.0
"""Where nobody watches a bar, a line this often."""


class Meter:
    """Means over the steps since the last row of the learning curve."""

    def __init__(self, images_per_step: int) -> None:
        self._images_per_step = images_per_step
        self._started = time.perf_counter()
        self._clear()

    def _clear(self) -> None:
        self._since = time.perf_counter()
        self._waited, self._steps = 0.0, 0
        self._sums: dict[str, Tensor] = {}

    @contextmanager
    def waiting(self) -> Iterator[None]:
        """Times a wait for data."""
        start = time.perf_counter()
        yield
        self._waited += time.perf_counter() - start

    def add(self, terms: Mapping[str, Tensor]) -> None:
        """One good step with its loss terms."""
        self._steps += 1
        for name, value in terms.items():
            self._sums[name] = self._sums.get(name, 0.0) + value.detach()

    @property
    def minutes(self) -> float:
        """Since the run was started or resumed."""
        return (time.perf_counter() - self._started) / 60.0

    def row(self, rate: float) -> dict[str, float]:
        """Learning rate, speed, share of time spent waiting for data, mean loss terms; starts the next span."""
        span = time.perf_counter() - self._since
        speed = {"images_per_s": round(self._steps * self._images_per_step / span, 3), "waiting": self._waited / span}
        means = {name: float(total) / self._steps for name, total in self._sums.items()}
        self._clear()
        return {"rate": rate} | speed | means


Show = Callable[[float, str], None]
"""`show(share, text)`: the share of the training that is done, and what else there is to say."""


@contextmanager
def progress_bar(done: float) -> Iterator[Show]:
    """A bar with time left on a terminal, a line on stderr every half minute elsewhere; `done` is the share so far."""
    console = Console(stderr=True)
    if not console.is_terminal:
        yield _lines(done)
        return
    columns = (BarColumn(), TaskProgressColumn(), TimeRemainingColumn(), TextColumn("{task.description}"))
    with Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=_BAR, completed=round(_BAR * done))
        yield lambda share, text: progress.update(task, completed=_BAR * share, description=text)


def _lines(done: float) -> Show:
    started = last = time.perf_counter()

    def show(share: float, text: str) -> None:
        nonlocal last
        now = time.perf_counter()
        if now - last >= LINE_EVERY_S:
            last = now
            left_min = (now - started) / max(share - done, 1e-9) * max(1.0 - share, 0.0) / 60.0
            print(f"training: {100 * share:.1f} %, {text}, {left_min:.0f} min left", file=sys.stderr, flush=True)

    return show
