"""How inner loops are compiled: one decorator, and the licences that some of them hold.

Every kernel is kept on disk, gives up Python's lock while it runs and takes bare arrays and numbers: it has no
annotations, and hooks that check shapes at run time leave it alone.
"""

import inspect
from collections.abc import Callable
from typing import TypeVar, no_type_check

from numba import njit

_Function = TypeVar("_Function", bound=Callable[..., object])


def _compiler(**licence: object) -> Callable[[_Function], _Function]:
    def compiled(function: _Function) -> _Function:
        return njit(cache=True, nogil=True, **licence)(no_type_check(inspect.unwrap(function)))  # pyright: ignore

    return compiled


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
