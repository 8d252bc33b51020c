"""How inner loops are compiled: one decorator, and the licences that some of them hold.

Every kernel is kept on disk and made anew when its file changes or one that it calls into. It gives up Python's lock
while it runs and takes bare arrays and numbers: it has no annotations, and hooks that check shapes leave it alone.
"""

import inspect
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar, no_type_check

from numba import njit

from proxnav.geometry.compiled.sources import digest

_PACKAGE = Path(__file__).parents[2]
_Function = TypeVar("_Function", bound=Callable[..., object])


def _compiler(**licence: object) -> Callable[[_Function], _Function]:
    def compiled(function: _Function) -> _Function:
        bare = inspect.unwrap(function)  # a hook may have wrapped it already
        dispatcher = njit(cache=True, nogil=True, **licence)(no_type_check(bare))  # pyright: ignore
        _watch_callees(dispatcher, Path(inspect.getfile(bare)))
        return dispatcher

    return compiled


def _watch_callees(dispatcher: Any, path: Path) -> None:
    """Code on disk becomes stale when any file changes from which the function's file takes functions or constants."""
    on_disk = getattr(getattr(dispatcher, "_cache", None), "_cache_file", None)
    if on_disk is not None and path.is_file():
        on_disk._source_stamp = on_disk._source_stamp, digest(path, _PACKAGE)


# Licences to round otherwise than written. Not reassociation: windows and whole images are to agree to the bit. Without
# numba's reference counting, handing tables from call to call costs nothing; with it a whole image takes twice as long.
_FAST = {"error_model": "numpy", "fastmath": {"nsz", "arcp", "contract", "afn"}, "_nrt": False}

kernel = _compiler()
"""Decorator of compiled functions: arithmetic as written, division by zero raises."""
pasted_kernel = _compiler(inline="always")
"""A kernel whose statements are pasted into its callers before types are inferred: for one-line helpers."""
ray_kernel = _compiler(error_model="numpy")
"""A kernel in which division by zero gives infinity or NaN: no test in front of each division."""
fast_kernel = _compiler(**_FAST)
"""A ray kernel that may round otherwise than written and that allocates nothing."""
fast_pasted_kernel = _compiler(**_FAST, inline="always")
"""A fast kernel whose statements are pasted into its callers before types are inferred."""
fast_inlined_kernel = _compiler(**_FAST, forceinline=True)
"""A fast kernel that runs once per pixel: a call would pass every array of an `Eye` or a `World` by value, at a word's
cost for each of their hundred and more numbers."""
