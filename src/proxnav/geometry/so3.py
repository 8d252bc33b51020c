"""Rotation vectors and their exponential, exact near 0 and near pi.

J. Sola, J. Deray, D. Atchuthan, "A micro Lie theory for state estimation in robotics", arXiv:1812.01537.
"""

import numpy as np

from proxnav.geometry import quaternion
from proxnav.geometry.types import Rotation3x3, Vector3


def skew(v: Vector3) -> Rotation3x3:
    """[v]x with [v]x w = v x w; batches lead."""
    x, y, z = np.moveaxis(v, -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def exp(phi: Vector3) -> Rotation3x3:
    """Rotation matrix of a rotation vector [rad]; batches lead."""
    return quaternion.to_matrix(quaternion.exp(phi))


def log(R: Rotation3x3) -> Vector3:
    """Rotation vector [rad] of length at most pi; batches lead. At exactly pi the axis sign is arbitrary."""
    return quaternion.log(quaternion.from_matrix(R))


def left_jacobian(phi: Vector3) -> Rotation3x3:
    """J_l(phi) with exp(phi + d) = exp(J_l(phi) d) exp(phi) to first order (Sola et al., eq. 145)."""
    angle2 = np.sum(phi * phi, axis=-1)[..., None, None]
    angle = np.sqrt(angle2)
    small = angle2 < 1e-8
    safe = np.where(small, 1.0, angle)
    a = np.where(small, 0.5 - angle2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    b = np.where(small, 1.0 / 6.0 - angle2 / 120.0, (safe - np.sin(safe)) / safe**3)
    K = skew(phi)
    return np.eye(3) + a * K + b * (K @ K)
