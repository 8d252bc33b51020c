"""All that the filter believes at one instant, as a value: keeping a belief is keeping a way back to it."""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.types import Rotation3x3, Vector3
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.kernels.published import pose_errors, published
from proxnav.navigation.kernels.seen_pose import true_pose
from proxnav.navigation.layout import N_FIXED, N_POSE, Covariance, PoseCovariance, StateVector, X
from proxnav.navigation.process_noise import SLOW_ACCELERATION
from proxnav.navigation.readings import GyroReading, StarFix
from proxnav.records import NavState, NavStatus

COAST_AFTER_S = 10.0
"""Without an accepted frame for so long the status is `coasting`: ten frames of a camera at 1 Hz."""
_NO_RATE = np.zeros(3)


def _no_reading_yet() -> GyroReading:
    return GyroReading(-np.inf, -np.inf, np.zeros(3), 0.0)


@dataclass(frozen=True, slots=True)
class Restart:
    """A pose that started a lost filter anew."""

    t: float
    refused: int
    """Frames that were refused among the last `frames`."""
    frames: int
    moved_m: float
    """How far the new start lies from where the filter was."""
    turned_rad: float

    @property
    def cause(self) -> str:
        """What happened, a clause for people."""
        return (
            f"{self.refused} of the last {self.frames} frames were refused; the pose that started it lies "
            f"{self.moved_m:.2f} m and {np.rad2deg(self.turned_rad):.1f} deg from where the filter was"
        )


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
    new_share: float = 0.0
    """Share of the poses' claimed covariance that is new in each frame, beyond what the error model says."""
    pose_count: float = 0.0
    """Poses that taught it, by what they are worth."""
    last_innovation: Float[np.ndarray, "6"] = field(default_factory=lambda: np.zeros(N_POSE))
    """Innovation of the last pose that taught, whitened."""
    log_memory: float = 0.0
    """Logarithm of how long the poses' errors last, in units of the error model's time."""
    slow_variance: Vector3 = field(default_factory=lambda: np.square(SLOW_ACCELERATION))
    """Variance of the slow acceleration, RIC axes [m^2/s^4], as the flight shows it."""
    turn_factor: float = 1.0
    """Size of the target's unmodelled angular acceleration as the flight shows it, in that assumed at first."""
    restarts: tuple[Restart, ...] = ()
    """All starts but the first."""


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


def camera_rate(belief: Tracking, setup: FilterSetup) -> Vector3:
    """Measured inertial rate of the camera, camera axes [rad/s]; zero without gyro, when the bias is minus the rate."""
    return belief.memory.gyro.rate_cam if setup.has_gyro else _NO_RATE


def turning(belief: Tracking, setup: FilterSetup) -> tuple[Rotation3x3, float, Vector3]:
    """`FilterSetup.turning` at the belief's time."""
    return setup.turning(belief.t, camera_rate(belief, setup))


def nav_state(belief: Tracking, setup: FilterSetup) -> NavState:
    """The belief as others read it."""
    x, P, turns = belief.x, belief.P[:N_FIXED, :N_FIXED], turning(belief, setup)
    R_eci_ric, _, _ = turns
    t_m, R_cam_target = true_pose(x, R_eci_ric)
    r_ric, v_ric, J = published(x, *turns)
    G = pose_errors(x, R_eci_ric)
    covariance, pose_covariance = J @ P @ J.T, G @ P @ G.T
    return NavState(
        t=belief.t, status=belief.status, r_ric_m=r_ric, v_ric_mps=v_ric,
        q_cam_target=quaternion.from_matrix(R_cam_target), t_cam_target_m=t_m, rate_target=x[X.rate],
        gyro_bias=x[X.gyro_bias], gnss_bias_m=x[X.gnss_bias], covariance=0.5 * (covariance + covariance.T),
        pose_covariance=0.5 * (pose_covariance + pose_covariance.T),
    )  # fmt: skip
