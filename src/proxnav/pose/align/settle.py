"""Gauss-Newton steps that pull a pose's outline onto the edges of the image, from a wide reach to a narrow one."""

from dataclasses import dataclass

import numpy as np

from proxnav.geometry import Pose
from proxnav.pose.align.config import AlignConfig
from proxnav.pose.align.kernels.edges import edge_equations
from proxnav.pose.align.kernels.steps import take_step
from proxnav.pose.align.outline import outline
from proxnav.pose.align.prior import Prior
from proxnav.pose.align.view import View
from proxnav.targets import Target

_FEWEST = 30
"""Points of the outline below which the image says too little."""
_APART_PX = 6.0
"""Distance along a line at which two points are taken to err independently."""


@dataclass(frozen=True, slots=True)
class Stage:
    """Steps on one outline."""

    blur_px: float
    reach_px: float
    """How far along the normals edges are looked for, at least."""
    sigmas_px: tuple[float, ...]
    """Of the Gaussian in which edges count, one for each step."""
    spacing_px: float


ROUGH = (Stage(1.5, 8.0, (5.0, 4.0, 3.0), 4.0), Stage(1.0, 6.0, (2.5, 2.0, 1.5), 3.0))
FINE = (Stage(0.5, 6.0, (2.0, 1.5, 1.2), 2.0), Stage(0.0, 4.0, (1.2, 1.0, 0.8, 0.6, 0.5), 2.0))


@dataclass(frozen=True, slots=True, eq=False)
class Settled:
    """Where the steps ended."""

    T_cam_target: Pose
    information: np.ndarray
    """(6, 6) of outline and prior, about that pose."""


def settle(
    target: Target,
    start: Pose,
    view: View,
    prior: Prior,
    stages: tuple[Stage, ...],
    prior_scale: float,
    config: AlignConfig,
) -> Settled | None:
    """The pose at which edges and `prior_scale` times the prior agree; None where the outline is too short."""
    R, t, information = start.R.copy(), start.t_m.copy(), prior.information.copy()
    R0, t0 = prior.T_cam_target.R, prior.T_cam_target.t_m
    H, g, R2, t2 = np.empty((6, 6)), np.empty(6), np.empty((3, 3)), np.empty(3)
    for stage in stages:
        lines = outline(target, R, t, view, stage.spacing_px)
        if len(lines.points_m) < _FEWEST:
            return None
        points, normals = lines.points_m, lines.normals
        gx, gy = view.gradients(stage.blur_px)
        least = (0.3 + view.noise) / max(1.0, stage.blur_px)
        for sigma in stage.sigmas_px:
            reach = max(stage.reach_px, 3.0 * sigma)
            edge_equations(points, normals, R, t, view.lens, gx, gy, reach, sigma, least, config.outlier, H, g)
            weight = min(1.0, stage.spacing_px / _APART_PX) * 2.0 / sigma**2
            take_step(R, t, H, g, weight, prior.information, R0, t0, prior_scale, information, R2, t2)
            R[:], t[:] = R2, t2
    return Settled(Pose.from_matrix("cam", "target", R, t), information)
