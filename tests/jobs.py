"""Jobs for tests of process pools; here so that a spawned process can import them by name."""

import os
import signal
from pathlib import Path

from proxnav.errors import InputError


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


class CannotBegin:
    """A job whose tool is not there."""

    def __call__(self):
        raise InputError("no tool here; install it")


class Interrupted:
    """A job whose worker gets Ctrl-C at each item."""

    def __call__(self):
        def work(x: int) -> int:
            os.kill(os.getpid(), signal.SIGINT)
            return x

        return work


class FailAtThree:
    """A job that cannot do one of its items, however often it tries."""

    def __call__(self):
        def work(x: int) -> int:
            if x == 3:
                raise ValueError(f"cannot do {x}")
            return x

        return work


class Same:
    """A job that gives each item back."""

    def __call__(self):
        return lambda x: x


class Threads:
    """A job that says how many threads the libraries of its process were allowed."""

    def __call__(self):
        import cv2

        return lambda x: (cv2.getNumThreads(), os.environ["OPENBLAS_NUM_THREADS"])


class LeaveName:
    """A job whose workers write down their process ids."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __call__(self):
        (self.folder / str(os.getpid())).touch()
        return lambda x: x
