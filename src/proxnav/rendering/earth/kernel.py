"""How the per-ray functions are compiled."""

import functools

from numba import njit

# Per-ray functions allocate nothing. Without numba's reference counting, handing tables from call to call costs nothing
# either; with it a whole image takes more than twice as long.
_FAST: set[str] = {"nsz", "arcp", "contract", "afn"}
"""Licences to round otherwise than written. Not reassociation: windows and whole images are to agree to the bit."""
kernel = functools.partial(  # pyright: ignore
    njit, cache=True, nogil=True, _nrt=False, error_model="numpy", fastmath=_FAST
)
"""Decorator of functions that run per ray and allocate nothing; used as `@kernel()`."""
inlined = functools.partial(kernel, forceinline=True)  # pyright: ignore
"""The same for what runs once per pixel: a call passes every array of an `Eye` or a `World` by value, at a word's cost
for each of their hundred and more numbers."""
