"""Error of one estimated pose, and the scores that are in use for it.

E_T = |t_est - t_true| per axis and as a norm, E_TN = norm / |t_true|, E_R = angle between the attitudes,
E_C = E_TN + E_R[rad].
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.geometry.arrays import frozen

_SPEC2021_DEAD_ZONE = np.radians(0.169), 2.173e-3  # rad and m/m: accuracy of the truth in SPEED+'s laboratory
_LABORATORY_DEAD_ZONE = np.radians(0.5), 5e-3


@dataclass(frozen=True, slots=True, eq=False)
class PoseErrors:
    """Errors of T_cam_target, in the camera frame."""

    e_t_m: np.ndarray
    """(3,) absolute position error per camera axis [m]."""
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


def spec2021_score(errors: PoseErrors) -> float:
    """Score of the challenge of 2021: each term counts zero below 0.169 deg or 2.173 mm/m."""
    return _dead_zone_score(errors, *_SPEC2021_DEAD_ZONE)


def laboratory_score(errors: PoseErrors) -> float:
    """The later dead zones: each term counts zero below 0.5 deg or 5 mm/m."""
    return _dead_zone_score(errors, *_LABORATORY_DEAD_ZONE)


def _dead_zone_score(errors: PoseErrors, least_rad: float, least_tn: float) -> float:
    turn = errors.e_r_rad if errors.e_r_rad >= least_rad else 0.0
    return turn + (errors.e_tn if errors.e_tn >= least_tn else 0.0)


COMBINED: Mapping[str, Callable[[PoseErrors], float]] = {
    "e_tn + e_r [rad]": lambda e: e.e_c,
    "e_tn + e_r / pi": lambda e: e.e_tn + e.e_r_rad / np.pi,
    "mean axis e_t / range + e_r [rad]": lambda e: _mean_axis_share(e) + e.e_r_rad,
    "e_t [m] + e_r [rad]": lambda e: e.e_t_norm_m + e.e_r_rad,
    "SPEC2021 dead zone (0.169 deg, 2.173 mm/m)": spec2021_score,
    "laboratory dead zone (0.5 deg, 5 mm/m)": laboratory_score,
}
"""Named definitions of a combined error. The study does not say which is its E_C; we use the first."""


def _mean_axis_share(errors: PoseErrors) -> float:
    """Mean over the axes of the position error, over the range."""
    return float(errors.e_t_m.mean()) * (errors.e_tn / errors.e_t_norm_m if errors.e_t_norm_m > 0.0 else 0.0)
