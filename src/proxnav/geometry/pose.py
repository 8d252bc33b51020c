"""Rigid transforms that know their frames: p_a = T_a_b @ p_b."""

from dataclasses import dataclass
from typing import overload

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.arrays import frozen
from proxnav.geometry.types import Numbers, Vector3

LARGEST_ROUNDING = 0.05
"""Largest element of R R^T - 1 that counts as rounding: that of LM-O reaches 0.01."""


def rounding_of(R: Float[np.ndarray, "3 3"]) -> float:
    """Largest element of |R R^T - 1|: 0 for a rotation."""
    return float(np.abs(R @ R.T - np.eye(3)).max())


@dataclass(frozen=True, slots=True, eq=False)
class Pose:
    """T_a_b maps b-coordinates to a-coordinates: p_a = R(q_a_b) p_b + t, t = origin of b seen from a, in a's axes.

    >>> T_cam_target = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 10])
    >>> T_cam_target @ np.array([1.0, 0.0, 0.0])
    array([ 1.,  0., 10.])
    >>> (T_cam_target @ T_cam_target.inverse()).frames
    ('cam', 'cam')
    """

    a: str
    """Frame of the result."""
    b: str
    """Frame of the argument."""
    q_wxyz: Float[np.ndarray, "wxyz=4"]
    """Hamilton quaternion q_a_b, unit."""
    t_m: Float[np.ndarray, "3"]
    """Translation r_a_b [m]."""

    def __post_init__(self) -> None:
        q = np.array(self.q_wxyz, dtype=np.float64)
        norm = np.linalg.norm(q)
        if not abs(norm - 1.0) < 1e-4:
            raise InputError(f"T_{self.a}_{self.b} needs a unit quaternion wxyz, found {q.tolist()} of norm {norm:.6g}")
        object.__setattr__(self, "q_wxyz", frozen(q / norm, (4,), "q_wxyz"))
        t_m = frozen(self.t_m, (3,), "t_m")
        if not np.isfinite(t_m).all():
            raise InputError(f"T_{self.a}_{self.b} needs a finite translation [m], found {t_m.tolist()}")
        object.__setattr__(self, "t_m", t_m)

    @staticmethod
    def from_wxyz(a: str, b: str, q_wxyz: Numbers, t_m: Numbers) -> "Pose":
        """T_a_b from the quaternion q_a_b (scalar first) and the position of b's origin in a [m]."""
        q, t = np.asarray(q_wxyz, dtype=np.float64), np.asarray(t_m, dtype=np.float64)
        if q.shape != (4,) or t.shape != (3,):
            raise InputError(
                f"T_{a}_{b} needs 4 numbers q_wxyz and 3 numbers t_m, found shapes {q.shape} and {t.shape}"
            )
        return Pose(a, b, q, t)

    @staticmethod
    def from_matrix(a: str, b: str, R: Numbers, t_m: Numbers) -> "Pose":
        """T_a_b from R_a_b (3x3, a rotation to 1e-6) and r_a_b [m]."""
        R = np.asarray(R, dtype=np.float64)
        proper = R.shape == (3, 3) and np.allclose(R @ R.T, np.eye(3), atol=1e-6) and np.linalg.det(R) > 0
        if not proper:
            raise InputError(f"R_{a}_{b} is not a rotation matrix: found {R.tolist()}; check rows and columns")
        return Pose.from_wxyz(a, b, quaternion.from_matrix(R), t_m)

    @staticmethod
    def from_rounded_matrix(a: str, b: str, R: Numbers, t_m: Numbers) -> "Pose":
        """As `from_matrix`, of a matrix that was rounded when it was written: T_a_b of the rotation nearest to it.

        InputError where R R^T departs from the identity by more than 0.05, or R mirrors.
        """
        given = np.asarray(R, dtype=np.float64)
        if given.shape != (3, 3) or not rounding_of(given) <= LARGEST_ROUNDING or not np.linalg.det(given) > 0.0:
            raise InputError(f"R_{a}_{b} is not a rotation matrix: found {given.tolist()}; check rows and columns")
        U, _, Vt = np.linalg.svd(given)  # Schoenemann 1966: the orthogonal matrix nearest in the Frobenius norm
        return Pose.from_matrix(a, b, U @ Vt, t_m)

    @staticmethod
    def identity(a: str, b: str) -> "Pose":
        """Frames with common origin and axes."""
        return Pose.from_wxyz(a, b, quaternion.IDENTITY, np.zeros(3))

    @property
    def frames(self) -> tuple[str, str]:
        """(a, b) of T_a_b."""
        return self.a, self.b

    @property
    def R(self) -> Float[np.ndarray, "3 3"]:
        """Rotation matrix R_a_b."""
        return quaternion.to_matrix(self.q_wxyz)

    def matrix(self) -> Float[np.ndarray, "4 4"]:
        """Homogeneous matrix."""
        M = np.eye(4)
        M[:3, :3], M[:3, 3] = self.R, self.t_m
        return M

    def inverse(self) -> "Pose":
        """T_b_a."""
        q_b_a = quaternion.conjugate(self.q_wxyz)
        return Pose(self.b, self.a, q_b_a, -quaternion.rotate(q_b_a, self.t_m))

    @overload
    def __matmul__(self, other: "Pose") -> "Pose": ...
    @overload
    def __matmul__(self, other: np.ndarray) -> np.ndarray: ...
    def __matmul__(self, other: "Pose | np.ndarray") -> "Pose | np.ndarray":
        """T_a_b @ T_b_c = T_a_c; T_a_b @ points (..., 3) in b gives points in a."""
        if isinstance(other, Pose):
            return self._compose(other)
        return self.transform(np.asarray(other, dtype=np.float64))

    def transform(self, points_b: Vector3) -> Vector3:
        """Points (..., 3) from b to a [m]."""
        return points_b @ self.R.T + self.t_m

    def _compose(self, other: "Pose") -> "Pose":
        if self.b != other.a:
            raise InputError(
                f"T_{self.a}_{self.b} @ T_{other.a}_{other.b}: inner frames differ ('{self.b}' and '{other.a}'); "
                "invert one of them or check the order"
            )
        q_a_c = quaternion.multiply(self.q_wxyz, other.q_wxyz)
        return Pose(self.a, other.b, q_a_c, self.transform(other.t_m))
