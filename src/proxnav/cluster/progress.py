"""How long work tells whoever waits for it how far it is."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

Progress = Callable[[str, int], AbstractContextManager[Callable[[], None]]]
"""`with progress(job, total) as done:` and a call of `done()` after each item."""


@contextmanager
def silent(job: str, total: int) -> Iterator[Callable[[], None]]:
    """Tells nobody."""
    yield lambda: None
