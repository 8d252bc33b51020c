"""Large tables: made once, kept on disk, mapped read-only so that worker processes share one copy in memory."""

import contextlib
import os
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from proxnav.storage.cache import cache_folder


def stored(name: str, make: Callable[[], np.ndarray]) -> np.ndarray:
    """The array kept under `name`, made when absent; read-only. Works without a writable folder, then in memory."""
    path = cache_folder() / f"{name}.npy"
    try:
        return _mapped(path)
    except (OSError, ValueError):
        array = np.ascontiguousarray(make())
    try:
        _write(path, array)
        return _mapped(path)
    except OSError:
        array.setflags(write=False)
        return array


def _mapped(path: Path) -> np.ndarray:
    array = np.asarray(np.load(path, mmap_mode="r", allow_pickle=False))
    array.max()  # touches every page once: the resident size does not grow later, frame by frame
    return array


def _write(path: Path, array: np.ndarray) -> None:
    """Atomic, so that a killed or a concurrent writer leaves no half file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    handle, temporary = tempfile.mkstemp(dir=path.parent, suffix=".part")
    try:
        with os.fdopen(handle, "wb") as file:
            np.save(file, array)
        Path(temporary).replace(path)
    except BaseException:
        with contextlib.suppress(OSError):
            Path(temporary).unlink()
        raise
