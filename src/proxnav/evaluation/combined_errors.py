"""Scores that combine the position and the attitude error of a pose in one number."""

from collections.abc import Callable, Mapping

import numpy as np

from proxnav.geometry.pose_errors import PoseErrors

_SPEC2021_DEAD_ZONE = np.radians(0.169), 2.173e-3  # rad and m/m: accuracy of the truth in SPEED+'s laboratory
_LABORATORY_DEAD_ZONE = np.radians(0.5), 5e-3


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
