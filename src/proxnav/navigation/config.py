"""What the filter assumes about motion and sensors, and how it judges."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from proxnav.datasets.records.scene import Triple
from proxnav.errors import InputError


@dataclass(frozen=True)
class FilterNoise:
    """Process noise and first uncertainties, one standard deviation each."""

    acceleration: float = 1e-6
    """White acceleration [m/s^2 per sqrt(Hz)]: what the dynamics leave out."""
    slow_acceleration: float = 4e-7
    """Differential drag and J2 [m/s^2], as a process that forgets in `slow_tau_s`."""
    slow_tau_s: float = 900.0
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
    target_rate_walk: float = 2.4e-5
    """Wandering of the target's rate [rad/s per sqrt(s)]."""
    target_rate: float = 5e-4
    """First uncertainty of the target's rate [rad/s]; use 0.05 for a tumbling target."""
    velocity: float = 0.3
    """First uncertainty of the relative velocity [m/s]."""
    accelerometer: float = 1.0e-3
    """Velocity random walk [m/s/sqrt(s)], while burning."""
    burn_share: float = 2e-3
    """Scale and alignment errors of a burn, as a share of it."""
    gnss_bias_m: float = 0.3
    gnss_tau_s: float = 300.0
    camera_tau_s: float = 60.0
    """How long the detector's errors last."""
    camera_share: float = 0.5
    """Share of the keypoints' (or poses') variance that lasts; the rest is new in every frame."""

    def vector(self, has_gyro: bool) -> Float[np.ndarray, "10"]:
        """For the compiled prediction, whose places it follows."""
        walk = self.gyro_bias_walk if has_gyro else self.rate_walk_without_gyro
        gyro = self.gyro if has_gyro else 0.0
        return np.array(
            [self.acceleration**2, self.slow_acceleration, self.slow_tau_s, gyro**2, walk**2, self.target_rate_walk**2,
             self.gnss_bias_m, self.gnss_tau_s, self.camera_tau_s, 0.0]
        )  # fmt: skip


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

    coupling: Literal["tight", "loose"] = "tight"
    """tight: each keypoint by itself; loose: poses of the pose solver."""
    dynamics: Literal["auto", "circular", "eccentric"] = "auto"
    """Clohessy-Wiltshire, Yamanaka-Ankersen, or by the eccentricity of the ephemeris."""
    target_rate: Literal["lvlh", "free"] = "lvlh"
    """Before the first frames the target turns with the orbit, or nobody knows."""
    inertia: Triple | None = None
    """Principal moments of a free target along its axes, up to a common factor; None: its rate only wanders."""
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
        if not 0.0 <= self.noise.camera_share < 1.0:
            raise InputError(f"camera_share must be in [0, 1), found {self.noise.camera_share}")
        if not self.buffer_s > 0.0:
            raise InputError(f"buffer_s must be positive, found {self.buffer_s}")
