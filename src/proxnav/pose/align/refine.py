"""Gauss-Newton steps that pull a pose's outline onto the edges of the image, from a wide reach to a narrow one."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Pose
from proxnav.pose.align.kernels.edges import edge_equations
from proxnav.pose.align.kernels.steps import take_step
from proxnav.pose.align.outline import outline
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.target_crop import TargetCrop
from proxnav.targets import Target

OUTLIER = 0.3
"""Weight of 'no edge here' against an edge of three times the least strength at offset 0."""
_FEWEST = 30
"""Points of the outline below which the image says too little."""
_APART_PX = 6.0
"""Distance along a line at which two points are taken to err independently."""


@dataclass(frozen=True, slots=True)
class Round:
    """Steps on one outline."""

    blur_px: float
    reach_px: float
    """How far along the normals edges are looked for, at least."""
    sigmas_px: tuple[float, ...]
    """Standard deviation of the Gaussian in which edges count, one for each step."""
    spacing_px: float


@dataclass(frozen=True, slots=True)
class Schedule:
    """Rounds, one after the other, under one prior."""

    prior_weight: float
    """Weight of the keypoint pose against points of the outline, which err together."""
    rounds: tuple[Round, ...]


ROUGH = Schedule(5.0, (Round(1.5, 8.0, (5.0, 4.0, 3.0), 4.0), Round(1.0, 6.0, (2.5, 2.0, 1.5), 3.0)))
FINE = Schedule(1.0, (Round(0.5, 6.0, (2.0, 1.5, 1.2), 2.0), Round(0.0, 4.0, (1.2, 1.0, 0.8, 0.6, 0.5), 2.0)))


def _weight(spacing_px: float, sigma: float) -> float:
    """Weight of a point of the outline in a step with Gaussians of `sigma` px."""
    return min(1.0, spacing_px / _APART_PX) * 2.0 / sigma**2


_LAST = FINE.rounds[-1]
LAST_STEP = _LAST.spacing_px, _weight(_LAST.spacing_px, _LAST.sigmas_px[-1])
"""(distance of points along the outline [px], weight of each) in the step that a pose ends with."""


@dataclass(frozen=True, slots=True, eq=False)
class Refined:
    """Where the steps ended."""

    T_cam_target: Pose
    information: Float[np.ndarray, "6 6"]
    """Inverse covariance of (dt, dr) by outline and prior, about that pose."""


def refine(target: Target, start: Pose, crop: TargetCrop, prior: Prior, schedule: Schedule) -> Refined | None:
    """The pose at which the edges and the weighted prior agree; None where the outline is too short."""
    R, t, information = start.R.copy(), start.t_m.copy(), prior.information.copy()
    R0, t0 = prior.T_cam_target.R, prior.T_cam_target.t_m
    H, g, R2, t2 = np.empty((6, 6)), np.empty(6), np.empty((3, 3)), np.empty(3)
    for turn in schedule.rounds:
        lines = outline(target, R, t, crop, turn.spacing_px)
        if len(lines.points_m) < _FEWEST:
            return None
        points, normals = lines.points_m, lines.normals
        gx, gy = crop.gradients(turn.blur_px)
        least = (0.3 + crop.noise) / max(1.0, turn.blur_px)
        for sigma in turn.sigmas_px:
            reach = max(turn.reach_px, 3.0 * sigma)
            edge_equations(points, normals, R, t, crop.lens, gx, gy, reach, sigma, least, OUTLIER, H, g)
            weight = _weight(turn.spacing_px, sigma)
            take_step(R, t, H, g, weight, prior.information, R0, t0, schedule.prior_weight, information, R2, t2)
            R[:], t[:] = R2, t2
    return Refined(Pose.from_matrix("cam", "target", R, t), information)
