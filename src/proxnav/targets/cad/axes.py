"""From the axes of a mesh file to the target frame: +x forward, +y right, +z down."""

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError

_LETTERS = "xyz"


def axis_vector(name: str) -> Float[np.ndarray, "3"]:
    """Unit vector of an axis written as x, +x or -x."""
    letter, sign = name.strip().lower().lstrip("+-"), name.strip()[:1]
    if len(letter) != 1 or letter not in _LETTERS or len(name.strip()) > 2:
        raise InputError(f"axis '{name}' is not one of x, y, z, -x, -y, -z")
    vector = np.zeros(3)
    vector[_LETTERS.index(letter)] = -1.0 if sign == "-" else 1.0
    return vector


def R_target_file(up: str, forward: str) -> Float[np.ndarray, "3 3"]:
    """Rotation from file axes to the target frame, where -z is the file's `up` and +x its `forward`.

    >>> R_target_file(up="y", forward="z") @ np.array([0.0, 1.0, 0.0])
    array([ 0.,  0., -1.])
    """
    x, z = axis_vector(forward), -axis_vector(up)
    if abs(float(x @ z)) > 0.5:
        raise InputError(f"up '{up}' and forward '{forward}' lie on one axis; choose two different ones")
    return np.stack([x, np.cross(z, x), z]) + 0.0  # no negative zeros
