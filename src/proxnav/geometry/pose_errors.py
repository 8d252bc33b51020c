"""Error of one estimated pose.

E_T = |t_est - t_true| per axis and as a norm, E_TN = norm / |t_true|, E_R = angle between the attitudes,
E_C = E_TN + E_R[rad].
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.geometry.arrays import frozen
from proxnav.geometry.pose import Pose

HALF_TURN_RAD = np.pi / 2.0
"""An attitude error beyond it took one side of the target for another."""


@dataclass(frozen=True, slots=True, eq=False)
class PoseErrors:
    """Errors of T_cam_target, in the camera frame."""

    e_t_m: Float[np.ndarray, "3"]
    """Absolute position error per camera axis [m]: right, down, forward."""
    e_t_norm_m: float
    e_tn: float
    """Norm of the position error over the true range."""
    e_r_rad: float
    e_c: float
    """E_TN + E_R[rad], which is also the score of the SPEED challenge of 2019."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "e_t_m", frozen(self.e_t_m, (3,), "e_t_m"))


def pose_errors(T_est: Pose, T_true: Pose) -> PoseErrors:
    """Errors of an estimate of T_cam_target.

    >>> T_true = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0, 0, 10])
    >>> T_est = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [0.3, 0, 10.4])
    >>> errors = pose_errors(T_est, T_true)
    >>> round(errors.e_t_norm_m, 6), round(errors.e_tn, 6), round(errors.e_c, 6)
    (0.5, 0.05, 0.05)
    """
    if T_est.frames != T_true.frames:
        names = ["T_" + "_".join(T.frames) for T in (T_est, T_true)]
        raise InputError(f"an estimate {names[0]} cannot be compared with a truth {names[1]}; invert one of them")
    range_m = float(np.linalg.norm(T_true.t_m))
    if range_m == 0.0:
        raise InputError("the true range is 0 m, so the position error over range is not defined")
    e_t_m = np.abs(T_est.t_m - T_true.t_m)
    e_t_norm_m = float(np.linalg.norm(e_t_m))
    e_r_rad = float(quaternion.angle_between(T_est.q_wxyz, T_true.q_wxyz))
    e_tn = e_t_norm_m / range_m
    return PoseErrors(e_t_m, e_t_norm_m, e_tn, e_r_rad, e_tn + e_r_rad)
