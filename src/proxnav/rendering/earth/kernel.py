"""How the per-ray functions are compiled."""

import functools

from numba import njit

# Per-ray functions allocate nothing. Without numba's reference counting, handing tables from call to call costs nothing
# either; with it a whole image takes more than twice as long.
kernel = functools.partial(njit, cache=True, nogil=True, _nrt=False)  # pyright: ignore
"""Decorator of functions that run per ray and allocate nothing; used as `@kernel()`."""
