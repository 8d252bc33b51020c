"""What records of others may mean instead of what the tables ask for."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import permutations, product

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.types import QuatWxyz, Rotation3x3


@dataclass(frozen=True, slots=True)
class Convention:
    """Another meaning of quaternions in a file."""

    name: str
    """Ends the sentence "the quaternions of ... look "; empty for what the tables ask for."""
    read: Callable[[QuatWxyz], QuatWxyz]
    """Quaternions as they stand in the file to those that the tables ask for."""


def signed_axes() -> Iterator[tuple[str, Rotation3x3]]:
    """(name, matrix) of the 48 permutations of axes with signs; the first is the identity.

    >>> dict(signed_axes())["(-y, x, z)"] @ [1.0, 2.0, 3.0]
    array([-2.,  1.,  3.])
    """
    for order in permutations(range(3)):
        for signs in product((1.0, -1.0), repeat=3):
            M = np.zeros((3, 3))
            M[range(3), order] = signs
            words = [("-" if sign < 0.0 else "") + "xyz"[axis] for sign, axis in zip(signs, order, strict=True)]
            yield f"({', '.join(words)})", M


def turned_axes() -> Iterator[tuple[str, Rotation3x3]]:
    """Those of `signed_axes` that are rotations, without the identity."""
    return ((name, M) for name, M in signed_axes() if np.linalg.det(M) > 0.0 and not np.array_equal(M, np.eye(3)))


def scalar_first(q: QuatWxyz) -> QuatWxyz:
    """Quaternions whose file has the scalar last."""
    return np.roll(q, 1, axis=-1)


def _turned_back(M: Rotation3x3) -> Callable[[QuatWxyz], QuatWxyz]:
    p = quaternion.from_matrix(M)
    return lambda q: quaternion.multiply(q, p)


def _as_they_are(q: QuatWxyz) -> QuatWxyz:
    return q


AS_ASKED = Convention("", _as_they_are)
READINGS_OF_QUATERNIONS = (
    AS_ASKED,
    Convention("conjugated", quaternion.conjugate),
    Convention("written with the scalar last", scalar_first),
    Convention("conjugated and written with the scalar last", lambda q: quaternion.conjugate(scalar_first(q))),
)
MOUNTINGS = tuple(
    Convention(f"those of axes {name} of the camera, a mounting that is left out", _turned_back(M))
    for name, M in turned_axes()
)
"""The star tracker in axes of its own, a quarter or half turn away."""

SIGNED_AXES: Float[np.ndarray, "48 3 3"] = np.array([M for _, M in signed_axes()])
