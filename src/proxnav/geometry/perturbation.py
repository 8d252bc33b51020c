"""Small steps between poses, in the parameters that pose covariances are written in: (dt, dr), t + dt, exp(dr) R."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import so3
from proxnav.geometry.pose import Pose

TRANSLATION, ROTATION = slice(0, 3), slice(3, 6)
"""Blocks of (dt [m], dr [rad]) and of its covariance."""


def difference(T_from: Pose, T_to: Pose) -> Float[np.ndarray, "6"]:
    """(dt, dr) that lead from one pose to another of the same frames: translation [m], rotation [rad], axes of a."""
    return np.concatenate([T_to.t_m - T_from.t_m, so3.log(T_to.R @ T_from.R.T)])


def moved(pose: Pose, step: Float[np.ndarray, "6"]) -> Pose:
    """The pose after (dt, dr): inverse of `difference`.

    >>> step = np.array([0.1, 0.0, -0.2, 0.0, 0.3, 0.0])
    >>> difference(Pose.identity("cam", "target"), moved(Pose.identity("cam", "target"), step)).round(9).tolist()
    [0.1, 0.0, -0.2, 0.0, 0.3, 0.0]
    """
    return Pose.from_matrix(pose.a, pose.b, so3.exp(step[ROTATION]) @ pose.R, pose.t_m + step[TRANSLATION])
