"""Cameras and bodies that point somewhere: attitudes from a direction and an up vector."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.arrays import cross, unit
from proxnav.geometry.types import QuatWxyz, Vector3

_NEARLY_ALONG = 1e-6  # sine of the angle below which `up` does not define the roll


def q_a_cam_looking(direction_a: Vector3, up_a: Vector3, fallback_up_a: Vector3) -> QuatWxyz:
    """q_a_cam of cameras whose z looks along `direction_a` and whose -y is as near to `up_a` as can be.

    Where the direction is along `up_a`, the fallback decides; all vectors in axes a, batches lead.

    >>> q_a_cam_looking(np.array([1.0, 0, 0]), np.array([0.0, 0, 1]), np.array([0.0, 1, 0]))  # x ahead, z up
    array([ 0.5, -0.5,  0.5, -0.5])
    """
    z = unit(direction_a)
    x = cross(z, up_a)
    vague = np.linalg.norm(x, axis=-1, keepdims=True) < _NEARLY_ALONG * np.linalg.norm(up_a, axis=-1, keepdims=True)
    x = unit(np.where(vague, cross(z, fallback_up_a), x))
    return quaternion.from_matrix(np.stack([x, cross(z, x), z], axis=-1))


def q_between(a: Vector3, b: Vector3) -> QuatWxyz:
    """The smallest rotation that turns the unit vectors `a` into `b`; about any normal axis where b = -a."""
    w = 1.0 + np.sum(a * b, axis=-1, keepdims=True)
    flipped = w < 1e-12
    spare = cross(a, np.where(np.abs(a[..., :1]) < 0.6, [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
    axis = np.where(flipped, spare, cross(a, b))
    return quaternion.normalize(np.concatenate([np.where(flipped, 0.0, w), axis], axis=-1))


def phase_angle(to_sun: Vector3, to_camera: Vector3) -> Float[np.ndarray, "*#batch"] | float:
    """Angle at the target [rad] between the unit direction to the Sun and the camera; 0 is light from behind it."""
    cosine = np.sum(to_sun * to_camera, axis=-1) / np.linalg.norm(to_camera, axis=-1)
    return np.arccos(np.clip(cosine, -1.0, 1.0))


def continuous(q: QuatWxyz) -> QuatWxyz:
    """A series (n, 4) with signs chosen so that neighbours lie in the same hemisphere."""
    flips = np.where(np.sum(q[1:] * q[:-1], axis=-1) < 0.0, -1.0, 1.0)
    return q * np.concatenate([[1.0], np.cumprod(flips)])[:, None]
