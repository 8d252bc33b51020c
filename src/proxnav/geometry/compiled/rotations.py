"""Quaternions and cross-product matrices for compiled code; conventions as in proxnav.geometry.quaternion."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel


@kernel
def to_matrix(q):
    """R(q), q wxyz and unit."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    R = np.empty((3, 3))
    R[0, 0], R[0, 1], R[0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return R


@kernel
def exp(phi):
    """Quaternion of a rotation vector [rad]."""
    angle = math.sqrt(phi[0] ** 2 + phi[1] ** 2 + phi[2] ** 2)
    scale = 0.5 if angle < 1e-9 else math.sin(0.5 * angle) / angle
    q = np.empty(4)
    q[0] = math.cos(0.5 * angle)
    q[1:] = scale * phi
    return q


@kernel
def log(q):
    """Rotation vector [rad] of length at most pi."""
    sign = -1.0 if q[0] < 0.0 else 1.0
    sine = math.sqrt(q[1] ** 2 + q[2] ** 2 + q[3] ** 2)
    scale = 2.0 if sine < 1e-9 else 2.0 * math.atan2(sine, sign * q[0]) / sine
    return sign * scale * q[1:]


@kernel
def multiply(p, q):
    """p (x) q, normalised."""
    out = np.empty(4)
    out[0] = p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3]
    out[1] = p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2]
    out[2] = p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1]
    out[3] = p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0]
    return out / math.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2 + out[3] ** 2)


@kernel
def conjugate(q):
    """The inverse rotation."""
    out = -q
    out[0] = q[0]
    return out


@kernel
def skew(v):
    """[v]x."""
    K = np.zeros((3, 3))
    K[0, 1], K[0, 2], K[1, 0] = -v[2], v[1], v[2]
    K[1, 2], K[2, 0], K[2, 1] = -v[0], -v[1], v[0]
    return K
