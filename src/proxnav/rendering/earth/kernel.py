"""How the per-ray functions are compiled."""

import functools

from numba import njit

# Per-ray functions allocate nothing. Without numba's reference counting, handing tables from call to call costs nothing
# either: it takes most of the time otherwise (measured: 4 times as long for a whole image).
kernel = functools.partial(njit, cache=True, nogil=True, _nrt=False)
"""Decorator of functions that run per ray and allocate nothing; used as `@kernel()`."""
