"""Hamilton quaternions, scalar first (wxyz), unit, active: v_a = R(q_a_b) v_b. Batches lead.

Formulas: J. Sola, "Quaternion kinematics for the error-state Kalman filter", arXiv:1711.02508.
"""

import numpy as np
from jaxtyping import Float
from scipy.spatial.transform import Rotation

from proxnav.geometry.arrays import cross
from proxnav.geometry.types import QuatWxyz, Rotation3x3, Vector3

IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])


def normalize(q: QuatWxyz) -> QuatWxyz:
    """The unit quaternion along `q`; the sign is kept."""
    return q / np.linalg.norm(q, axis=-1, keepdims=True)


def canonical(q: QuatWxyz) -> QuatWxyz:
    """The representative with w >= 0 of the pair (q, -q): for files and comparisons, never inside a filter."""
    return np.where(q[..., :1] < 0.0, -q, q)


def conjugate(q: QuatWxyz) -> QuatWxyz:
    """q_b_a of q_a_b."""
    return q * np.array([1.0, -1.0, -1.0, -1.0])


def multiply(p: QuatWxyz, q: QuatWxyz) -> QuatWxyz:
    """q_a_c = q_a_b (x) q_b_c (Sola, eq. 12)."""
    pw, px, py, pz = np.moveaxis(p, -1, 0)
    qw, qx, qy, qz = np.moveaxis(q, -1, 0)
    w = pw * qw - px * qx - py * qy - pz * qz
    x = pw * qx + px * qw + py * qz - pz * qy
    y = pw * qy - px * qz + py * qw + pz * qx
    z = pw * qz + px * qy - py * qx + pz * qw
    return np.stack([w, x, y, z], axis=-1)


def rotate(q: QuatWxyz, v: Vector3) -> Vector3:
    """v_a = R(q_a_b) v_b."""
    w, u = q[..., :1], q[..., 1:]
    uv = cross(u, v)
    return v + 2.0 * (w * uv + cross(u, uv))


def exp(phi: Vector3) -> QuatWxyz:
    """Quaternion of a rotation vector [rad] (Sola, eq. 101)."""
    angle = np.linalg.norm(phi, axis=-1, keepdims=True)
    return np.concatenate([np.cos(0.5 * angle), 0.5 * np.sinc(angle / (2.0 * np.pi)) * phi], axis=-1)


def log(q: QuatWxyz) -> Vector3:
    """Rotation vector [rad] of length at most pi; q and -q give the same (Sola, eq. 105)."""
    q = canonical(q)
    w, u = q[..., :1], q[..., 1:]
    sine = np.linalg.norm(u, axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(sine, w)
    small = sine < 1e-9
    return u * np.where(small, 2.0, angle / np.where(small, 1.0, sine))


def angle_between(p: QuatWxyz, q: QuatWxyz) -> Float[np.ndarray, "*#batch"] | float:
    """Angle [rad] in [0, pi] of the rotation from p to q, exact for small angles where 2 arccos|p.q| is not."""
    return np.linalg.norm(log(multiply(conjugate(p), q)), axis=-1)


def to_matrix(q: QuatWxyz) -> Rotation3x3:
    """R(q_a_b), which maps b-coordinates to a (Sola, eq. 115)."""
    flat = Rotation.from_quat(q.reshape(-1, 4), scalar_first=True).as_matrix()
    return flat.reshape(*q.shape[:-1], 3, 3)


def from_matrix(R: Rotation3x3) -> QuatWxyz:
    """q_a_b of R_a_b, with w >= 0."""
    flat = Rotation.from_matrix(R.reshape(-1, 3, 3)).as_quat(canonical=True, scalar_first=True)
    return flat.reshape(*R.shape[:-2], 4)


def random(rng: np.random.Generator, count: int) -> Float[np.ndarray, "count wxyz=4"]:
    """Attitudes uniform on SO(3)."""
    return normalize(rng.normal(size=(count, 4)))


def slerp(q0: QuatWxyz, q1: QuatWxyz, fraction: Float[np.ndarray, "*#batch"] | float) -> QuatWxyz:
    """The shorter great arc from q0 (fraction 0) to q1 (fraction 1)."""
    step = log(multiply(conjugate(q0), q1))
    return multiply(q0, exp(np.asarray(fraction)[..., None] * step))
