"""What the filter assumes about motion and sensors, and how it judges."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from proxnav.errors import InputError
from proxnav.records.error_model import KeypointErrorModel, PoseErrorModel
from proxnav.records.scene import Triple


@dataclass(frozen=True)
class FilterNoise:
    """Process noise and first uncertainties, one standard deviation each."""

    acceleration: float = 1e-7
    """White acceleration [m/s^2 per sqrt(Hz)]: what the dynamics leave out."""
    slow_acceleration: Triple = (2e-8, 2.5e-7, 2e-8)
    """Differential drag [m/s^2] in RIC axes, as a process that forgets in `slow_tau_s`; it acts along the flight."""
    slow_tau_s: float = 3000.0
    gyro: float = 4.4e-5
    """Angle random walk [rad/sqrt(s)]."""
    gyro_bias_walk: float = 2e-7
    """[rad/s per sqrt(s)]: bias instability, and scale and misalignment while the rate changes."""
    gyro_bias: float = 1e-4
    """First uncertainty of the bias [rad/s]."""
    rate_walk_without_gyro: float = 1.1e-4
    """Without gyro the camera's rate itself wanders [rad/s per sqrt(s)]."""
    rate_without_gyro: float = 5e-3
    """First uncertainty of that rate [rad/s]."""
    held_rate: float = 3e-4
    """How wrong the last rate may be where gyro readings are missing [rad/s]."""
    free_rate_walk: float = 2.4e-5
    """Wandering of a free target's rate [rad/s per sqrt(s)]."""
    free_rate: float = 0.05
    """First uncertainty of a free target's rate [rad/s]."""
    velocity: float = 0.3
    """First uncertainty of the relative velocity [m/s]."""
    accelerometer: float = 1.0e-3
    """Velocity random walk [m/s/sqrt(s)], while burning."""
    burn_share: float = 2e-3
    """Scale and alignment errors of a burn, as a share of it."""
    gnss_bias_m: float = 0.3
    gnss_tau_s: float = 300.0
    camera: KeypointErrorModel = field(default_factory=KeypointErrorModel)
    """Of keypoints, for tight coupling."""
    poses: PoseErrorModel = field(default_factory=PoseErrorModel)
    """Of poses, for loose coupling."""


@dataclass(frozen=True)
class HeldTarget:
    """A target whose attitude is controlled: it wanders about an attitude that is fixed in LVLH."""

    sigma_deg: float = 0.3
    """Standard deviation about each axis."""
    period_s: float = 300.0
    """Of the control loop."""
    damping: float = 0.7
    q_lvlh_target: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """The attitude that is held (LVLH: x along the flight, z to nadir)."""

    @property
    def frequency(self) -> float:
        """Of the control loop [rad/s]."""
        return 2.0 * np.pi / self.period_s

    @property
    def rate_walk(self) -> float:
        """Random walk of the rate that keeps the wander at `sigma_deg` [rad/s per sqrt(s)]."""
        return float(np.deg2rad(self.sigma_deg) * np.sqrt(4.0 * self.damping * self.frequency**3))


@dataclass(frozen=True)
class GateConfig:
    """Chi-square gates, as probabilities that an honest measurement passes."""

    keypoint: float = 0.99
    frame: float = 0.9999
    fix: float = 0.999
    """GNSS and star tracker."""
    least_share: float = 0.5
    """A frame counts when at least this share of its keypoints agrees with the prediction."""

    def keypoint_gate(self) -> float:
        """Squared distance, two degrees of freedom."""
        return float(chi2.ppf(self.keypoint, 2))

    def frame_gates(self, most: int) -> Float[np.ndarray, "n"]:
        """Squared distance by degrees of freedom, from 0 to `most`."""
        return np.concatenate([[0.0], chi2.ppf(self.frame, np.arange(1, most + 1))])


@dataclass(frozen=True)
class LossConfig:
    """When the filter says that it has lost the target and starts anew."""

    coast_after_s: float = 10.0
    """Without an accepted frame for so long the status is `coasting`."""
    window: int = 16
    """So many last frames are judged together..."""
    most_rejected: float = 0.7
    """... and with more than this share of them refused the filter is lost: the next pose starts it again."""
    fix_streak: int = 8
    """So many refused fixes in a row and the filter gives the fix its way: attitude, gyro bias or GNSS bias restart."""


@dataclass(frozen=True)
class NavigationConfig:
    """The filter."""

    coupling: Literal["loose", "tight"] = "loose"
    """loose: the estimator's poses, which are finer than its keypoints; tight: each keypoint by itself."""
    target: Literal["held", "free"] = "held"
    """Whether somebody controls the target's attitude."""
    held: HeldTarget = field(default_factory=HeldTarget)
    """How a controlled target is held."""
    inertia: Triple | None = None
    """Principal moments of a free target along its axes, up to a common factor; None: its rate only wanders."""
    inertia_sigma: float = 0.05
    """How wrong each of them may be, as a share of it."""
    gyro: bool = True
    gnss: bool = True
    accelerometer: Literal["burns", "always", "never"] = "burns"
    """burns: while a thruster is open, or where nobody knows, above `burn_threshold_mps2`.

    always: as naive fusion does, for comparison; do not use it.
    """
    burn_threshold_mps2: float = 0.02
    """2 mg: far above noise and bias of the accelerometer."""
    noise: FilterNoise = field(default_factory=FilterNoise)
    gates: GateConfig = field(default_factory=GateConfig)
    loss: LossConfig = field(default_factory=LossConfig)
    buffer_s: float = 15.0
    """Measurements that arrive later than this are counted and left out."""
    chaser_antenna_cam_m: Triple = (0.0, -0.15, -0.1)
    target_antenna_target_m: Triple = (-2.0, 0.0, -1.2)

    def __post_init__(self) -> None:
        if not self.buffer_s > 0.0:
            raise InputError(f"buffer_s must be positive, found {self.buffer_s}")
        if not (self.held.sigma_deg > 0.0 and self.held.period_s > 0.0 and self.held.damping > 0.0):
            raise InputError("held.sigma_deg, held.period_s and held.damping must be positive")

    def noise_vector(self, has_gyro: bool) -> Float[np.ndarray, "12"]:
        """For the compiled prediction, whose places it follows."""
        n = self.noise
        walk = n.gyro_bias_walk if has_gyro else n.rate_walk_without_gyro
        gyro = n.gyro if has_gyro else 0.0
        rate_walk = self.held.rate_walk if self.target == "held" else n.free_rate_walk
        return np.array(
            [n.acceleration**2, *n.slow_acceleration, n.slow_tau_s, gyro**2, walk**2, rate_walk**2,
             n.gnss_bias_m, n.gnss_tau_s, n.camera.tau_s if self.coupling == "tight" else n.poses.tau_s, 0.0]
        )  # fmt: skip
