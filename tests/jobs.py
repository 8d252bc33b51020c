"""Jobs for tests of process pools; here so that a spawned process can import them by name."""

import os
import signal
from pathlib import Path


class Square:
    """A job that can be pickled: builds the function that squares."""

    def __call__(self):
        return lambda x: x * x


class DieOnce:
    """A job whose first worker is killed at item 3; a file remembers that it happened."""

    def __init__(self, mark: Path) -> None:
        self.mark = mark

    def __call__(self):
        def work(x: int) -> int:
            if x == 3 and not self.mark.exists():
                self.mark.touch()
                os.kill(os.getpid(), signal.SIGKILL)
            return -x

        return work


class Fail:
    """A job that refuses."""

    def __call__(self):
        def work(x: int) -> int:
            raise ValueError(f"cannot do {x}")

        return work
