"""One processor a worker: libraries that start threads of their own are told so before they are loaded."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

LIBRARIES = ("OMP", "OPENBLAS", "MKL", "NUMBA")
ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in LIBRARIES} | {"OPENCV_FOR_THREADS_NUM": "1"}
"""What each library reads, once, when it is loaded. Workers that each take all processors wait for one another."""


@contextmanager
def one_thread_each() -> Iterator[None]:
    """Processes that are started while the block runs have one thread a library; what is set already stays as it is."""
    added = {name: value for name, value in ONE_THREAD.items() if name not in os.environ}
    os.environ.update(added)
    try:
        yield
    finally:
        for name in added:
            del os.environ[name]
