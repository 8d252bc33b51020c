"""Quaternions and cross-product matrices for compiled code; conventions as in proxnav.geometry.quaternion."""

import math

import numpy as np

from proxnav.geometry.compiled.kernel import kernel
from proxnav.geometry.compiled.vectors import dot


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


@kernel
def log_matrix(R):
    """Rotation vector [rad] of a matrix, for turns below half a turn."""
    v = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = math.sqrt(dot(v, v))
    if sine < 1e-12:
        return v
    return v * (math.atan2(sine, 0.5 * (R[0, 0] + R[1, 1] + R[2, 2] - 1.0)) / sine)


@kernel
def from_matrix(R):
    """Unit quaternion wxyz of a rotation matrix, largest component first computed (S. W. Shepperd, 1978)."""
    q = np.empty(4)
    trace = R[0, 0] + R[1, 1] + R[2, 2]
    i = 0
    for k in range(1, 3):
        if R[k, k] > R[i, i]:
            i = k
    if trace > R[i, i]:
        q[0] = 1.0 + trace
        q[1], q[2], q[3] = R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    else:
        j, k = (i + 1) % 3, (i + 2) % 3
        q[0], q[1 + i] = R[k, j] - R[j, k], 1.0 - trace + 2.0 * R[i, i]
        q[1 + j], q[1 + k] = R[j, i] + R[i, j], R[k, i] + R[i, k]
    return q / math.sqrt(np.sum(q * q))
