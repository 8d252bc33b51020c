"""The pose on which most points agree, and the best pose that contradicts it."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import so3
from proxnav.geometry.types import Flags, Rotation3x3, Vector3
from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.intake import Correspondences
from proxnav.pose.solve.kernels.consensus import MODES, compete, search
from proxnav.pose.solve.kernels.refinement import distances, normal_equations, refine
from proxnav.pose.solve.kernels.weights import weigh

LOSSES = {"squares": 0, "huber": 1, "cauchy": 2}
_LOSS2 = 2.5**2  # squared standard deviations at which the robust loss leaves the square
_WEIGHT_FLOOR_PX2 = 1e-6  # keeps a zero covariance invertible
_GATE_FLOOR_PX2 = 0.5**2  # variance added to every keypoint's own in the gate, not in the weights
_SEARCH_WIDENING = 2.0  # a pose of three noisy points is worse than the refined one: the search gate is wider
_MIRROR_STEPS = 8  # Levenberg-Marquardt steps given to the pose behind the camera


PixelInformation = Float[np.ndarray, "used 3"]
"""Inverse covariance of each pixel, a row as in `kernels.weights`."""


@dataclass(frozen=True, slots=True, eq=False)
class Fit:
    """A pose of the centred points and what speaks for it and against it."""

    R: Rotation3x3
    t: Float[np.ndarray, "3"]
    use: Flags
    info: PixelInformation
    cost: float
    """Sum of squared normalised errors, each at most the squared gate."""
    rival_R: Rotation3x3
    """Rotation of the best pose at another optimum; `rival_cost` is infinite where there is none."""
    rival_cost: float

    def d2(self, data: Correspondences) -> Float[np.ndarray, "used"]:
        """Squared Mahalanobis reprojection errors."""
        return _d2(self.R, self.t, data, self.info)


def fit_consensus(data: Correspondences, scale: float, config: PoseConfig) -> Fit | None:
    """The best pose in front of the camera, keypoint noise taken `scale` times as large; None without a triangle."""
    info, gate_info, ray_info = _weights(data, scale)
    modes_R, modes_t, costs = _search(data, ray_info, 1.0, config)
    if not np.isfinite(costs).any():
        return None
    use = np.zeros(len(data.X), dtype=bool)
    best, cost, rival, rival_cost = compete(
        modes_R, modes_t, costs, data.X, data.pixels, info, gate_info, data.lens, config.gate_sigma**2,
        LOSSES[config.loss], _LOSS2, _SEARCH_WIDENING, use,
    )  # fmt: skip
    return Fit(modes_R[best], modes_t[best], use, info, cost, modes_R[rival], rival_cost)


def agrees(fit: Fit | None, data: Correspondences, config: PoseConfig) -> bool:
    """Whether enough points at distinct places rest on the pose."""
    return fit is not None and _is_consensus(fit.use, data, config)


def seen_from_behind(data: Correspondences, config: PoseConfig) -> bool:
    """Whether the points agree on a pose behind the camera, as a sign error or a mirrored axis makes them."""
    _, gate_info, ray_info = _weights(data, 1.0)
    modes_R, modes_t, costs = _search(data, ray_info, -1.0, config)
    best = int(np.argmin(costs))
    if not np.isfinite(costs[best]):
        return False
    close = _d2(modes_R[best], modes_t[best], data, gate_info, side=-1.0) <= config.gate_sigma**2
    return _is_consensus(close, data, config)


def information(fit: Fit, data: Correspondences, config: PoseConfig) -> Float[np.ndarray, "6 6"]:
    """J^T W J of (dt, dr) over the inliers, about the origin of the target's frame, translation first."""
    H, g = np.empty((6, 6)), np.empty(6)
    X, t = data.X + data.centroid, fit.t - fit.R @ data.centroid
    loss = LOSSES[config.loss]
    normal_equations(fit.R, t, X, data.pixels, fit.info, fit.use, data.lens, 1.0, loss, _LOSS2, H, g)
    return H


def cost_behind(fit: Fit, data: Correspondences, config: PoseConfig) -> float:
    """Cost of the pose behind the camera that looks most like this one: half a turn round the axis, depth reversed."""
    R, t = fit.R * [[-1.0], [-1.0], [1.0]], -fit.t
    loss, gate2 = LOSSES[config.loss], config.gate_sigma**2
    refine(R, t, data.X, data.pixels, fit.info, fit.use, data.lens, -1.0, loss, _LOSS2, _MIRROR_STEPS)
    return float(np.minimum(_d2(R, t, data, fit.info, side=-1.0), gate2).sum())


def robust_weights(fit: Fit, data: Correspondences, config: PoseConfig) -> Float[np.ndarray, "used"]:
    """Weight that the robust loss leaves each point at its error."""
    d2 = np.maximum(fit.d2(data), 1e-300)
    if config.loss == "cauchy":
        return 1.0 / (1.0 + d2 / _LOSS2)
    return np.minimum(1.0, np.sqrt(_LOSS2 / d2)) if config.loss == "huber" else np.ones(len(d2))


def rms_px(fit: Fit, data: Correspondences) -> float:
    """Root mean square reprojection error of the inliers [px]."""
    unit = np.zeros((len(data.X), 3))
    unit[:, 0] = unit[:, 2] = 1.0
    return float(np.sqrt(_d2(fit.R, fit.t, data, unit)[fit.use].mean()))


def turn_between(R: Rotation3x3, R_rival: Rotation3x3) -> Float[np.ndarray, "3"]:
    """Rotation vector dr with R_rival = exp(dr) R."""
    return so3.log(R_rival @ R.T)


def _is_consensus(use: Flags, data: Correspondences, config: PoseConfig) -> bool:
    count, n = int(np.count_nonzero(use)), len(use)
    places = count if data.places == n else len(set(data.label[use].tolist()))
    return places >= config.min_inliers and count >= config.min_inlier_share * n


def _weights(data: Correspondences, scale: float) -> tuple[PixelInformation, PixelInformation, PixelInformation]:
    """Inverse covariances of the pixels, those of the gate, and those of the gate on the plane z = 1."""
    info, gate_info, ray_info = np.empty((3, len(data.X), 3))
    covariances = data.covariances if scale == 1.0 else data.covariances * scale**2
    weigh(data.xy, covariances, _WEIGHT_FLOOR_PX2, _GATE_FLOOR_PX2, data.lens, info, gate_info, ray_info)
    if data.calibration_px is not None:  # the gate lets pass what the camera's own errors may do
        wider = covariances + data.calibration_px @ np.swapaxes(data.calibration_px, -1, -2)
        weigh(data.xy, wider, _WEIGHT_FLOOR_PX2, _GATE_FLOOR_PX2, data.lens, np.empty_like(info), gate_info, ray_info)
    return info, gate_info, ray_info


def _search(
    data: Correspondences, ray_info: PixelInformation, side: float, config: PoseConfig
) -> tuple[Float[np.ndarray, "modes 3 3"], Float[np.ndarray, "modes 3"], Float[np.ndarray, "modes"]]:
    """Rotations, translations and costs of the poses of three-point subsets; infinite costs stand for none."""
    modes_R, modes_t, costs = np.zeros((MODES, 3, 3)), np.zeros((MODES, 3)), np.full(MODES, np.inf)
    gate2 = (_SEARCH_WIDENING * config.gate_sigma) ** 2
    search(data.X, data.xy, ray_info, side, gate2, modes_R, modes_t, costs)
    return modes_R, modes_t, costs


def _d2(
    R: Rotation3x3, t: Vector3, data: Correspondences, info: PixelInformation, side: float = 1.0
) -> Float[np.ndarray, "used"]:
    d2 = np.empty(len(data.X))
    distances(R, t, data.X, data.pixels, info, data.lens, side, d2)
    return d2
