"""Basilisk's modified Rodrigues parameters and our quaternions.

sigma_BN and our q_N_B say the same: Basilisk's matrix [BN] turns components in N into components in B, ours the other
way round, and both have the same axis and angle.
"""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion, so3
from proxnav.geometry.types import QuatWxyz, Vector3


def q_n_b(sigma_bn: Vector3) -> QuatWxyz:
    """The quaternion q_N_B, scalar first, of the parameters sigma_BN (Schaub and Junkins, 4th ed., eq. 3.150).

    >>> q_n_b(np.array([0.0, 0.0, np.tan(np.pi / 8)])).round(4)  # B is turned by 90 deg about z
    array([0.7071, 0.    , 0.    , 0.7071])
    """
    sigma = np.asarray(sigma_bn, dtype=np.float64)
    square = float(sigma @ sigma)
    return np.concatenate([[1.0 - square], 2.0 * sigma]) / (1.0 + square)


def sigma_bn(q_n_b: QuatWxyz) -> Vector3:
    """Inverse of `q_n_b`: the parameters of the shorter of both turns, of length one at most."""
    q = quaternion.canonical(q_n_b)
    return q[1:] / (1.0 + q[0])


def sigma_by_turn(sigma: Vector3) -> Float[np.ndarray, "3 3"]:
    """d(sigma_BN) by a small turn of B about its own axes [1/rad] (Schaub and Junkins, eq. 3.160)."""
    square = float(sigma @ sigma)
    return 0.25 * ((1.0 - square) * np.eye(3) + 2.0 * so3.skew(sigma) + 2.0 * np.outer(sigma, sigma))
