"""One type for each kind of reading. `t` is when it was taken, `received` when it arrived, seconds since the epoch."""

from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.navigation.layout import PoseCovariance

SensorName = Literal["gyro", "accelerometer", "star_tracker", "gnss", "poses", "keypoints"]

ORDER: tuple[SensorName, ...] = ("gyro", "accelerometer", "star_tracker", "gnss", "poses", "keypoints")
"""Order of readings taken at one instant: first what moves the belief there, and a pose before its own keypoints."""


@dataclass(frozen=True, slots=True, eq=False)
class GyroReading:
    """Mean inertial rate over the step that ends at `t`."""

    sensor: ClassVar[SensorName] = "gyro"
    t: float
    received: float
    rate_cam: Vector3
    """Camera axes [rad/s]."""
    step_s: float

    @property
    def since(self) -> float:
        """When the step began: from there on the belief turns with this rate."""
        return self.t - self.step_s


@dataclass(frozen=True, slots=True, eq=False)
class Acceleration:
    """Mean specific force over the step that ends at `t`."""

    sensor: ClassVar[SensorName] = "accelerometer"
    t: float
    received: float
    specific_force: Vector3
    """Camera axes [m/s^2]."""
    thrust: float
    """1 where a thruster was open during the step, 0 where none was, -1 where nobody knows."""
    step_s: float


@dataclass(frozen=True, slots=True, eq=False)
class StarFix:
    """Attitude of the camera."""

    sensor: ClassVar[SensorName] = "star_tracker"
    t: float
    received: float
    q_eci_cam: QuatWxyz
    sigma_rad: Vector3
    """Standard deviations about the camera's axes."""


@dataclass(frozen=True, slots=True, eq=False)
class GnssFix:
    """Chaser's antenna relative to the target's antenna, ECI axes."""

    sensor: ClassVar[SensorName] = "gnss"
    t: float
    received: float
    position_m: Vector3
    velocity_mps: Vector3
    sigma_position_m: float
    """Standard deviation per axis."""
    sigma_velocity_mps: float


@dataclass(frozen=True, slots=True, eq=False)
class PoseFix:
    """T_cam_target from one frame, as a pose solver gives it."""

    sensor: ClassVar[SensorName] = "poses"
    t: float
    received: float
    q_cam_target: QuatWxyz
    t_cam_target_m: Vector3
    covariance: PoseCovariance
    """Covariance of (dt, dr) in camera axes."""


@dataclass(frozen=True, slots=True, eq=False)
class KeypointFrame:
    """Keypoints of one frame in the order of the target's list, of a camera without distortion."""

    sensor: ClassVar[SensorName] = "keypoints"
    t: float
    received: float
    pixels: Float[np.ndarray, "n_points 2"]
    """NaN where a point was not found [px], corner origin."""
    covariances_px2: Float[np.ndarray, "n_points 2 2"]


Reading = GyroReading | Acceleration | StarFix | GnssFix | PoseFix | KeypointFrame


def rank(reading: Reading) -> tuple[float, int]:
    """Order of application: by time, then by `ORDER`; a gyro's reading counts from the beginning of its step."""
    since = reading.since if isinstance(reading, GyroReading) else reading.t
    return since, ORDER.index(reading.sensor)
