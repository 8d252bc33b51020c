"""Where a target is and how it moves for the camera: a pose with constant rates on SE(3), each with its covariance."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Pose
from proxnav.geometry.perturbation import ROTATION, TRANSLATION, difference, moved
from proxnav.geometry.types import PoseCovariance

_POSE, _RATE = slice(0, 6), slice(6, 12)
_UNKNOWN_TURN_RADPS = np.deg2rad(4.0)
"""Standard deviation of the rates of a target of which one pose is known: tumbling craft turn so fast."""
_UNKNOWN_DRIFT = 0.005
"""Standard deviation of the speed of such a target, as a share of the range a second."""
_TURN_NOISE_RADPS2, _TURN_CHANGE = 5e-4, 0.7
"""Angular acceleration of a target that hardly turns, and that of one that tumbles as a share of its squared rate."""
_DRIFT_NOISE = 3e-4
"""Acceleration as a share of the range a second^2: thrusters, and the camera's own turning."""


@dataclass(frozen=True, slots=True, eq=False)
class Motion:
    """T_cam_target at `t` with constant velocity and angular rate, camera axes."""

    t: float
    """Instant [s]."""
    T_cam_target: Pose
    rate: Float[np.ndarray, "6"]
    """Rate of (t [m/s], r [rad/s]): t + v dt, exp(w dt) R."""
    covariance: Float[np.ndarray, "12 12"]
    """Covariance of the errors (dt, dr) of the pose, then of the rates."""

    @staticmethod
    def begun(t: float, T_cam_target: Pose, covariance: PoseCovariance) -> "Motion":
        """One pose, of a target whose rates nobody knows."""
        P = np.zeros((12, 12))
        P[_POSE, _POSE] = covariance
        drift = _UNKNOWN_DRIFT * float(np.linalg.norm(T_cam_target.t_m))
        P[_RATE, _RATE] = np.diag([drift**2] * 3 + [_UNKNOWN_TURN_RADPS**2] * 3)
        return Motion(t, T_cam_target, np.zeros(6), P)

    @property
    def pose_covariance(self) -> PoseCovariance:
        """Covariance of (dt [m], dr [rad]) of the pose."""
        return self.covariance[_POSE, _POSE]

    @property
    def turn_sigma_rad(self) -> float:
        """Standard deviation of the attitude about its least known axis."""
        return float(np.sqrt(np.linalg.eigvalsh(self.pose_covariance[ROTATION, ROTATION])[-1]))

    def at(self, t: float) -> "Motion":
        """The motion predicted to `t`, before or after."""
        dt = t - self.t
        F = np.eye(12)
        F[_POSE, _RATE] = dt * np.eye(6)
        P = F @ self.covariance @ F.T + self._noise(abs(dt))
        return Motion(t, moved(self.T_cam_target, dt * self.rate), self.rate, 0.5 * (P + P.T))

    def corrected(self, T_cam_target: Pose, covariance: PoseCovariance) -> "Motion":
        """The motion after a pose was measured at its instant: the Kalman update of pose and rates."""
        P = self.covariance
        K = P[:, _POSE] @ np.linalg.inv(P[_POSE, _POSE] + covariance)
        step = K @ difference(self.T_cam_target, T_cam_target)
        left = np.eye(12)
        left[:, _POSE] -= K
        P = left @ P @ left.T + K @ covariance @ K.T
        return Motion(self.t, moved(self.T_cam_target, step[_POSE]), self.rate + step[_RATE], 0.5 * (P + P.T))

    def distance2(self, T_cam_target: Pose, covariance: PoseCovariance) -> float:
        """Squared Mahalanobis distance of a measured pose, chi-square(6) where both covariances are honest."""
        d = difference(self.T_cam_target, T_cam_target)
        return float(d @ np.linalg.solve(self.pose_covariance + covariance, d))

    def _noise(self, dt: float) -> Float[np.ndarray, "12 12"]:
        """White accelerations over dt, integrated."""
        turn = _TURN_NOISE_RADPS2 + _TURN_CHANGE * float(self.rate[ROTATION] @ self.rate[ROTATION])
        drift = _DRIFT_NOISE * float(np.linalg.norm(self.T_cam_target.t_m))
        drift += float(np.linalg.norm(self.rate[ROTATION]) * np.linalg.norm(self.rate[TRANSLATION]))
        q = np.diag([drift**2] * 3 + [turn**2] * 3)
        Q = np.zeros((12, 12))
        Q[_POSE, _POSE], Q[_POSE, _RATE] = q * dt**4 / 4.0, q * dt**3 / 2.0
        Q[_RATE, _POSE], Q[_RATE, _RATE] = q * dt**3 / 2.0, q * dt**2
        return Q
