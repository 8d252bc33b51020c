"""One run, one folder: a second run into it is refused while the first lives. A lock dies with its process."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from proxnav.errors import InputError
from proxnav.storage.files import cannot_write

LOCK = ".lock"
"""Name of the file in the folder."""


@contextmanager
def only_run_in(folder: Path) -> Iterator[None]:
    """Holds the folder for this process while the block runs; InputError names the process that holds it already.

    The kernel gives the lock up when the process ends, however it ends: a file left behind locks nothing.
    """
    path = folder / LOCK
    try:
        folder.mkdir(parents=True, exist_ok=True)
        handle = _held(path)
    except OSError as error:
        raise cannot_write(path, error) from None
    try:
        yield
    finally:
        path.unlink(missing_ok=True)
        os.close(handle)


def _held(path: Path) -> int:
    """An open handle of the file, locked; the file may have been removed by the run that ended while we waited."""
    while True:
        handle = os.open(path, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            if not _lock(handle):
                raise InputError(f"{path.parent}: {_owner(handle)} writes into it; wait for it or give another folder")
            if path.exists() and os.path.samestat(os.fstat(handle), path.stat()):
                os.ftruncate(handle, 0)
                os.pwrite(handle, f"process {os.getpid()} on {socket.gethostname()}".encode(), 0)
                return handle
        except BaseException:
            os.close(handle)
            raise
        os.close(handle)


def _owner(handle: int) -> str:
    return os.pread(handle, 200, 0).decode(errors="replace").strip() or "another run"


def _lock(handle: int) -> bool:
    """Whether the lock is ours now; where the system has none, it is."""
    try:
        import fcntl
    except ImportError:  # Windows refuses to replace files that are open, which is the worst of it
        return True
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True
