"""Arrays as the plain tuples that a SceneSpec holds."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.records.scene import Quadruple, Triple


def triple(v: Float[np.ndarray, "3"]) -> Triple:
    """A vector as three Python floats."""
    x, y, z = v.tolist()
    return x, y, z


def quadruple(q: Float[np.ndarray, "wxyz=4"]) -> Quadruple:
    """A quaternion as four Python floats, w >= 0, of length one."""
    w, x, y, z = quaternion.canonical(quaternion.normalize(q)).tolist()
    return w, x, y, z


BEHIND_M: Triple = (0.0, 0.0, -50.0)
"""Position of a target behind the camera, which leaves the picture to the sky, camera axes [m]."""
