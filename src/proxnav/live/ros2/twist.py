"""How fast the target moves for the camera, from two poses."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Pose, quaternion
from proxnav.geometry.perturbation import ROTATION, TRANSLATION


@dataclass(frozen=True, slots=True, eq=False)
class MovingPose:
    """A pose of one instant."""

    t: float
    T_cam_target: Pose
    covariance: Float[np.ndarray, "6 6"]


@dataclass(frozen=True, slots=True, eq=False)
class TargetTwist:
    """Rates of the target with respect to the camera frame, in target axes."""

    linear_mps: Float[np.ndarray, "3"]
    angular_radps: Float[np.ndarray, "3"]
    covariance: Float[np.ndarray, "6 6"]
    """Covariance of (linear, angular)."""


def twist_between(before: MovingPose, now: MovingPose) -> TargetTwist:
    """The mean twist between two poses, with the covariance of two independent ones."""
    dt = now.t - before.t
    R = now.T_cam_target.R
    turn = quaternion.log(
        quaternion.multiply(quaternion.conjugate(before.T_cam_target.q_wxyz), now.T_cam_target.q_wxyz)
    )
    J = np.zeros((6, 6))
    J[TRANSLATION, TRANSLATION] = J[ROTATION, ROTATION] = R.T / dt
    covariance = J @ (before.covariance + now.covariance) @ J.T
    return TargetTwist(R.T @ (now.T_cam_target.t_m - before.T_cam_target.t_m) / dt, turn / dt, covariance)
