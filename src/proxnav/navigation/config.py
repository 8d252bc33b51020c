"""What the filter assumes about motion and sensors."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.navigation.mounting import Mounting
from proxnav.records.error_model import KeypointErrorModel, PoseErrorModel
from proxnav.records.navigation import Antennas
from proxnav.records.scene import Triple

CONTROL_DAMPING = 0.7
"""Damping of a second-order attitude control loop, as it is designed: fast without much overshoot."""


@dataclass(frozen=True)
class FilterNoise:
    """Process noise and first uncertainties of what differs from craft to craft, one standard deviation each."""

    acceleration: float = 1e-7
    """White acceleration [m/s^2 per sqrt(Hz)]: what the dynamics leave out."""
    gyro: float = 4.4e-5
    """Angle random walk [rad/sqrt(s)]."""
    gyro_bias_walk: float = 2e-7
    """[rad/s per sqrt(s)]: bias instability, and scale and misalignment while the rate changes."""
    gyro_bias: float = 1e-4
    """First uncertainty of the bias [rad/s]."""
    free_rate_walk: float = 2.4e-5
    """Wandering of a free target's rate [rad/s per sqrt(s)]."""
    free_rate: float = 0.05
    """First uncertainty of a free target's rate [rad/s]."""
    accelerometer: float = 1.0e-3
    """Velocity random walk [m/s/sqrt(s)], while burning."""
    gnss_bias_m: float = 0.3
    """Slow error of the GNSS baseline, per axis."""
    gnss_tau_s: float = 300.0
    """How long it lasts."""
    camera: KeypointErrorModel = field(default_factory=KeypointErrorModel)
    """Errors of keypoints, for tight coupling."""
    poses: PoseErrorModel = field(default_factory=PoseErrorModel)
    """Errors of poses, for loose coupling."""


@dataclass(frozen=True)
class CraftGeometry:
    """Where things sit on both craft and how far that is known: each sigma is of one axis, and zero means exactly.

    What is not known exactly is estimated; what the flight does not show keeps its first uncertainty.
    """

    target_centre_m: Triple = (0.0, 0.0, 0.0)
    """Centre of mass of the target, target axes."""
    target_centre_sigma_m: float = 0.3
    chaser_centre_cam_m: Triple = (0.0, 0.0, 0.0)
    """Centre of mass of the chaser, camera axes from the camera."""
    chaser_centre_sigma_m: float = 0.5
    misalignment_sigma_deg: float = 0.1
    """How far the camera may be turned against the axes in which gyro and star tracker report."""
    clock_sigma_s: float = 0.3
    """How far the stamps of frames may be off."""

    def __post_init__(self) -> None:
        sigmas = (self.target_centre_sigma_m, self.chaser_centre_sigma_m, self.misalignment_sigma_deg)
        if not min(*sigmas, self.clock_sigma_s) >= 0.0:
            raise InputError("geometry: the sigmas must be at least 0, where 0 means known exactly")

    @property
    def sigmas(self) -> Float[np.ndarray, "10"]:
        """First standard deviations of the errors `E.geometry`, SI."""
        misalignment = float(np.deg2rad(self.misalignment_sigma_deg))
        three = np.repeat([self.target_centre_sigma_m, self.chaser_centre_sigma_m, misalignment], 3)
        return np.append(three, self.clock_sigma_s)


SURVEYED = CraftGeometry(
    target_centre_sigma_m=0.0, chaser_centre_sigma_m=0.0, misalignment_sigma_deg=0.0, clock_sigma_s=0.0
)
"""Craft whose camera sits at the centre of mass and looks at a target whose origin is its own, all known exactly."""


@dataclass(frozen=True)
class HeldTarget:
    """A target whose attitude is controlled: it wanders about an attitude that is fixed in LVLH."""

    sigma_deg: float = 0.3
    """Standard deviation about each axis."""
    period_s: float = 300.0
    """Natural period of the control loop."""
    q_lvlh_target: tuple[float, float, float, float] = (1.0, 0.0, 0.0, 0.0)
    """The attitude that is held (LVLH: x along the flight, z to nadir)."""

    @property
    def sigma(self) -> float:
        """Standard deviation about each axis [rad]."""
        return float(np.deg2rad(self.sigma_deg))

    @property
    def frequency(self) -> float:
        """Natural frequency of the control loop [rad/s]."""
        return 2.0 * np.pi / self.period_s

    @property
    def rate_walk(self) -> float:
        """Random walk of the rate that keeps the wander at `sigma_deg` [rad/s per sqrt(s)]."""
        return float(np.deg2rad(self.sigma_deg) * np.sqrt(4.0 * CONTROL_DAMPING * self.frequency**3))


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
    """burns: while a thruster is open, or where nobody knows, above 2 mg.

    always: as naive fusion does, for comparison; do not use it.
    """
    noise: FilterNoise = field(default_factory=FilterNoise)
    geometry: CraftGeometry = field(default_factory=CraftGeometry)
    """Where things sit on both craft, and how far that is known."""
    mounting: Mounting = field(default_factory=Mounting)
    """How gyro, accelerometer and star tracker are turned against the camera, whose axes records have otherwise."""
    chaser_antenna_cam_m: Triple | None = None
    """Where the chaser's GNSS antenna sits, camera axes [m]; None: as records.json says."""
    target_antenna_target_m: Triple | None = None
    """Where the target's GNSS antenna sits, target axes [m]; None: as records.json says."""

    def __post_init__(self) -> None:
        if (self.chaser_antenna_cam_m is None) != (self.target_antenna_target_m is None):
            raise InputError(
                "a GNSS baseline has two ends: give chaser_antenna_cam_m and target_antenna_target_m, or neither"
            )
        if not (self.held.sigma_deg > 0.0 and self.held.period_s > 0.0):
            raise InputError("held.sigma_deg and held.period_s must be positive")

    @property
    def antennas(self) -> Antennas | None:
        """Ends of the GNSS baseline, where they are given here."""
        if self.chaser_antenna_cam_m is None or self.target_antenna_target_m is None:
            return None
        return Antennas(self.chaser_antenna_cam_m, self.target_antenna_target_m)
