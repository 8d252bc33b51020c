"""All that the filter believes at one instant, as a value: keeping a belief is keeping a way back to it."""

from dataclasses import dataclass, field

import numpy as np

from proxnav.geometry import quaternion, so3
from proxnav.geometry.perturbation import ROTATION, TRANSLATION
from proxnav.geometry.types import Vector3
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.layout import N_FIXED, PUBLISHED, Covariance, E, PoseCovariance, StateVector, X
from proxnav.navigation.readings import GyroReading, StarFix
from proxnav.records import NavState, NavStatus

COAST_AFTER_S = 10.0
"""Without an accepted frame for so long the status is `coasting`: ten frames of a camera at 1 Hz."""


def _no_reading_yet() -> GyroReading:
    return GyroReading(-np.inf, -np.inf, np.zeros(3))


@dataclass(frozen=True, slots=True, eq=False)
class Memory:
    """What the filter remembers of its readings, with a state or without."""

    gyro: GyroReading = field(default_factory=_no_reading_yet)
    """The last one."""
    star: StarFix | None = None
    """The last one."""
    force_bias: Vector3 = field(default_factory=lambda: np.zeros(3))
    """Accelerometer bias as met while coasting [m/s^2]."""
    force_count: int = 0
    """Readings that taught it."""
    starts: int = 0
    """How often a pose has started the filter."""


@dataclass(frozen=True, slots=True, eq=False)
class Waiting:
    """Before the first pose: no state yet."""

    t: float
    memory: Memory = field(default_factory=Memory)

    @property
    def status(self) -> NavStatus:
        """What the belief is worth."""
        return "waiting"


@dataclass(frozen=True, slots=True, eq=False)
class Tracking:
    """A state with its covariance."""

    t: float
    x: StateVector
    P: Covariance
    camera_t: float
    """Time of the last accepted frame."""
    memory: Memory = field(default_factory=Memory)
    pose_errors: PoseCovariance = field(default_factory=lambda: np.zeros((6, 6)))
    """Covariance of the lasting pose errors in frames like the last: dt in camera, dr in target axes."""
    frames: tuple[bool, ...] = ()
    """Whether the last frames were accepted, the newest last."""
    star_streak: int = 0
    """Star tracker fixes refused in a row."""
    gnss_streak: int = 0
    is_lost: bool = False

    @property
    def status(self) -> NavStatus:
        """What the belief is worth."""
        if self.is_lost:
            return "lost"
        return "coasting" if self.has_coasted else "tracking"

    @property
    def has_coasted(self) -> bool:
        """Whether no frame was accepted for some time."""
        return self.t - self.camera_t > COAST_AFTER_S


Belief = Waiting | Tracking


def nav_state(belief: Tracking, setup: FilterSetup) -> NavState:
    """The belief as others read it."""
    x, P = belief.x, belief.P
    R_cam_ric = quaternion.to_matrix(x[X.q_eci_cam]).T @ setup.R_eci_ric(belief.t)
    R_cam_target, t_m = quaternion.to_matrix(x[X.q_cam_target]), -R_cam_ric @ x[X.position]
    G = np.zeros((6, N_FIXED))
    G[TRANSLATION, E.position], G[TRANSLATION, E.attitude_cam] = -R_cam_ric, so3.skew(t_m)
    G[ROTATION, E.attitude] = R_cam_target
    C = G @ P[:N_FIXED, :N_FIXED] @ G.T
    return NavState(
        t=belief.t, status=belief.status, r_ric_m=x[X.position], v_ric_mps=x[X.velocity],
        q_cam_target=quaternion.normalize(x[X.q_cam_target]), t_cam_target_m=t_m, rate_target=x[X.rate],
        gyro_bias=x[X.gyro_bias], gnss_bias_m=x[X.gnss_bias], covariance=P[np.ix_(PUBLISHED, PUBLISHED)],
        pose_covariance=0.5 * (C + C.T),
    )  # fmt: skip
