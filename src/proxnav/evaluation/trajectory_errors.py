"""Absolute and relative errors of a trajectory as SLAM tools give them, without alignment: APE and RPE.

The trajectory is that of the camera in the target's frame. Sturm et al., IROS 2012.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from proxnav.evaluation.pairing import PairedFrame
from proxnav.geometry import Pose, quaternion


@dataclass(frozen=True, slots=True)
class Statistics:
    """One error over a trajectory."""

    rmse: float
    mean: float
    median: float
    std: float
    min: float
    max: float


@dataclass(frozen=True, slots=True)
class TrajectoryErrors:
    """Errors of the poses (APE) and of the steps from one pose to the next (RPE)."""

    ape_m: Statistics
    ape_deg: Statistics
    rpe_m: Statistics
    rpe_deg: Statistics


def trajectory_errors(frames: Sequence[PairedFrame]) -> TrajectoryErrors | None:
    """Errors of the frames that have a pose, in their order; None where there are fewer than two."""
    both = [(f.T_est.inverse(), f.T_true.inverse()) for f in frames if f.T_est is not None]
    if len(both) < 2:
        return None
    absolute = [true.inverse() @ estimated for estimated, true in both]
    steps = [(a[1].inverse() @ b[1]).inverse() @ (a[0].inverse() @ b[0]) for a, b in pairwise(both)]
    return TrajectoryErrors(*_of(absolute), *_of(steps))


def _of(errors: Sequence[Pose]) -> tuple[Statistics, Statistics]:
    q, t_m = np.array([T.q_wxyz for T in errors]), np.array([T.t_m for T in errors])
    turn = np.degrees(quaternion.angle_between(quaternion.IDENTITY, q))
    return _statistics(np.linalg.norm(t_m, axis=1)), _statistics(np.asarray(turn))


def _statistics(values: Float[np.ndarray, "n"]) -> Statistics:
    return Statistics(
        float(np.sqrt((values**2).mean())), float(values.mean()), float(np.median(values)), float(values.std()),
        float(values.min()), float(values.max()),
    )  # fmt: skip
