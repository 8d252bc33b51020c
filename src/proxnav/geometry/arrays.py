"""Arrays as values: copied, typed and read-only, so that a frozen dataclass is frozen all the way down."""

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.types import Numbers


def frozen(values: Numbers, shape: tuple[int | None, ...], name: str, dtype: type = np.float64) -> np.ndarray:
    """A read-only copy of `values`; `None` in `shape` accepts any length. Raises InputError on another shape."""
    array = np.array(values, dtype=dtype)
    fits = array.ndim == len(shape) and all(want in (None, have) for want, have in zip(shape, array.shape, strict=True))
    if not fits:
        wanted = tuple("n" if want is None else want for want in shape)
        raise InputError(f"{name} needs shape {wanted}, found {array.shape}")
    array.setflags(write=False)
    return array


def unit(vectors: Float[np.ndarray, "*batch n"]) -> Float[np.ndarray, "*batch n"]:
    """Vectors scaled to length one."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def cross(a: Float[np.ndarray, "*a_batch 3"], b: Float[np.ndarray, "*b_batch 3"]) -> Float[np.ndarray, "*batch 3"]:
    """The cross product: numpy's to the bit, much faster for single vectors, of which every scene needs hundreds."""
    if a.ndim == b.ndim == 1:
        (ax, ay, az), (bx, by, bz) = a.tolist(), b.tolist()
        return np.array([ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx])
    return np.cross(a, b)
