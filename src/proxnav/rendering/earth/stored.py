"""Large tables: made once, kept on disk, mapped read-only so that worker processes share one copy in memory."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
from jaxtyping import Shaped

from proxnav.storage.cache import cache_folder
from proxnav.storage.files import replacing


def stored(name: str, make: Callable[[], np.ndarray]) -> Shaped[np.ndarray, "..."]:
    """The array kept under `name`, made when absent; read-only. Works without a writable folder, then in memory."""
    path = cache_folder() / f"{name}.npy"
    try:
        return _mapped(path)
    except (OSError, ValueError):
        array = np.ascontiguousarray(make())
    try:
        with replacing(path) as part, part.open("wb") as file:
            np.save(file, array)
        return _mapped(path)
    except OSError:
        array.setflags(write=False)
        return array


def _mapped(path: Path) -> Shaped[np.ndarray, "..."]:
    array = np.asarray(np.load(path, mmap_mode="r", allow_pickle=False))
    array.max()  # touches every page once: the resident size does not grow later, frame by frame
    return array
