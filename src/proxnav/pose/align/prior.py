"""What the keypoints say before the image itself is compared: a pose with its covariance."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Pose
from proxnav.geometry.perturbation import difference, moved
from proxnav.geometry.types import PoseCovariance
from proxnav.pose.align.config import USUAL_DOUBT
from proxnav.records import PoseResult

_LEVER_M = 6.0
"""Weight of a radian against a metre across the line of sight when axes of a covariance are compared."""
_ALONG = 0.15
"""Weight of a metre along the line of sight against one across it."""


@dataclass(frozen=True, slots=True, eq=False)
class Prior:
    """N(T, covariance), errors (dt, dr) with t_true = t + dt, R_true = exp(dr) R."""

    T_cam_target: Pose
    covariance: PoseCovariance
    information: Float[np.ndarray, "6 6"]
    """Inverse of the covariance."""
    doubt: float = USUAL_DOUBT
    """1 - median score of the keypoints."""
    calibration_moves: Float[np.ndarray, "6 calibration=3"] = field(default_factory=lambda: np.zeros((6, 3)))
    """As in `PoseResult`; the covariance is without them, because the edges see the same camera."""

    @staticmethod
    def of(T_cam_target: Pose, covariance: PoseCovariance, doubt: float = USUAL_DOUBT) -> "Prior":
        """The prior of a pose, its covariance and the keypoints' doubt, from a camera that is known exactly."""
        return Prior(T_cam_target, covariance, np.linalg.inv(covariance), doubt)

    @staticmethod
    def of_result(result: PoseResult, doubt: float) -> "Prior":
        """The prior that a pose of keypoints is; errors of the camera are kept apart from its covariance."""
        assert result.T_cam_target is not None
        assert result.covariance is not None
        moves = result.calibration_moves
        covariance = result.covariance - moves @ moves.T if moves.any() else result.covariance
        return Prior(result.T_cam_target, covariance, np.linalg.inv(covariance), doubt, moves)

    def offset(self, T_cam_target: Pose) -> Float[np.ndarray, "6"]:
        """(dt, dr) from the prior's pose to another."""
        return difference(self.T_cam_target, T_cam_target)

    def distance2(self, T_cam_target: Pose) -> float:
        """Squared Mahalanobis distance of another pose."""
        d = self.offset(T_cam_target)
        return float(d @ self.information @ d)

    def alternatives(self, axes: int, sigmas: tuple[float, ...]) -> list[Pose]:
        """Poses that many standard deviations away along the longest axes of the covariance."""
        scale = np.array([1.0, 1.0, _ALONG, _LEVER_M, _LEVER_M, _LEVER_M])
        variances, directions = np.linalg.eigh(self.covariance * np.outer(scale, scale))
        longest = range(5, 5 - axes, -1)
        steps = [np.sqrt(max(variances[i], 0.0)) * directions[:, i] / scale for i in longest]
        return [moved(self.T_cam_target, k * step) for step in steps for k in sigmas]
