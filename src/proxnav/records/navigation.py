"""What navigation takes and gives: readings of each sensor as columns, and the navigation solution.

Every reading has `t`, when it was taken, and where it can arrive late `received`, when the filter got it; both are
seconds since the run's epoch. Rows are in the order of arrival.
"""

from dataclasses import dataclass, fields
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.geometry.arrays import frozen
from proxnav.records.scene import Triple

NavStatus = Literal["waiting", "tracking", "coasting", "lost", "suspect"]
"""waiting: no pose yet; tracking: camera accepted lately; coasting: predicted; lost: measurements contradict it.

suspect: sensors contradict each other as a wrong convention of files does; the state's `cause` names it.
"""

NAV_STATUSES: tuple[NavStatus, ...] = ("waiting", "tracking", "coasting", "lost", "suspect")


class NavBlocks(NamedTuple):
    """Blocks of the errors of a navigation solution, and of both axes of its covariance."""

    position: slice
    """RIC axes [m]."""
    velocity: slice
    """RIC axes [m/s]."""
    attitude: slice
    """Target axes [rad]."""
    rate: slice
    """Target axes [rad/s]."""


NAV_ERRORS = NavBlocks(slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 12))


def _freeze(record: object, n: int, shapes: dict[str, tuple[int | None, ...]]) -> None:
    for f in fields(record):  # type: ignore[arg-type]
        if f.name in shapes:
            value = frozen(getattr(record, f.name), (n, *shapes[f.name]), f.name)
            object.__setattr__(record, f.name, value)


@dataclass(frozen=True, slots=True)
class Antennas:
    """Between which two points a GNSS baseline is measured."""

    chaser_cam_m: Triple
    """The chaser's antenna, camera axes from the camera's centre."""
    target_target_m: Triple
    """The target's antenna, target axes from the origin of the target's keypoints."""


@dataclass(frozen=True, slots=True, eq=False)
class EphemerisData:
    """Where a craft is, from its operator or its own receiver, ECI axes (J2000).

    That of the target defines RIC: errors of 100 m are harmless.
    """

    t: Float[np.ndarray, "n"]
    r_eci_m: Float[np.ndarray, "n 3"]
    v_eci_mps: Float[np.ndarray, "n 3"]

    def __post_init__(self) -> None:
        _freeze(self, len(self.t), {"t": (), "r_eci_m": (3,), "v_eci_mps": (3,)})


@dataclass(frozen=True, slots=True, eq=False)
class GyroData:
    """Mean inertial rate over the step that ends at `t`, camera axes [rad/s]."""

    t: Float[np.ndarray, "n"]
    rate: Float[np.ndarray, "n 3"]

    def __post_init__(self) -> None:
        _freeze(self, len(self.t), {"t": (), "rate": (3,)})


@dataclass(frozen=True, slots=True, eq=False)
class AccelerometerData:
    """Mean specific force over the step that ends at `t`, camera axes [m/s^2]."""

    t: Float[np.ndarray, "n"]
    specific_force: Float[np.ndarray, "n 3"]
    thrust: Float[np.ndarray, "n"]
    """1 where a thruster was open during the step, 0 where none was, -1 where nobody knows."""

    def __post_init__(self) -> None:
        _freeze(self, len(self.t), {"t": (), "specific_force": (3,), "thrust": ()})


@dataclass(frozen=True, slots=True, eq=False)
class GnssData:
    """Chaser's antenna relative to the target's antenna, ECI axes [m, m/s], with standard deviations per axis."""

    t: Float[np.ndarray, "n"]
    received: Float[np.ndarray, "n"]
    position_m: Float[np.ndarray, "n 3"]
    velocity_mps: Float[np.ndarray, "n 3"]
    sigma_position_m: Float[np.ndarray, "n"]
    sigma_velocity_mps: Float[np.ndarray, "n"]

    def __post_init__(self) -> None:
        shapes = {"t": (), "received": (), "position_m": (3,), "velocity_mps": (3,)}
        _freeze(self, len(self.t), shapes | {"sigma_position_m": (), "sigma_velocity_mps": ()})


@dataclass(frozen=True, slots=True, eq=False)
class StarTrackerData:
    """Attitude of the camera, with standard deviations about the camera's axes [rad]."""

    t: Float[np.ndarray, "n"]
    received: Float[np.ndarray, "n"]
    q_eci_cam: Float[np.ndarray, "n wxyz=4"]
    sigma_rad: Float[np.ndarray, "n 3"]

    def __post_init__(self) -> None:
        _freeze(self, len(self.t), {"t": (), "received": (), "q_eci_cam": (4,), "sigma_rad": (3,)})


@dataclass(frozen=True, slots=True, eq=False)
class KeypointData:
    """Keypoints of each frame in the order of the target's list; a point not found is NaN."""

    t: Float[np.ndarray, "n"]
    """Middle of the exposure."""
    received: Float[np.ndarray, "n"]
    pixels: Float[np.ndarray, "n n_keypoints 2"]
    """Keypoints [px], corner origin."""
    covariances_px2: Float[np.ndarray, "n n_keypoints 2 2"]

    def __post_init__(self) -> None:
        k = self.pixels.shape[1] if self.pixels.ndim > 1 else 0
        _freeze(self, len(self.t), {"t": (), "received": (), "pixels": (k, 2), "covariances_px2": (k, 2, 2)})


@dataclass(frozen=True, slots=True, eq=False)
class PoseData:
    """T_cam_target of each frame with the covariance of (dt, dr) in camera axes, as PoseResult has it."""

    t: Float[np.ndarray, "n"]
    received: Float[np.ndarray, "n"]
    q_cam_target: Float[np.ndarray, "n wxyz=4"]
    t_cam_target_m: Float[np.ndarray, "n 3"]
    covariance: Float[np.ndarray, "n 6 6"]

    def __post_init__(self) -> None:
        shapes = {"t": (), "received": (), "q_cam_target": (4,), "t_cam_target_m": (3,), "covariance": (6, 6)}
        _freeze(self, len(self.t), shapes)


@dataclass(frozen=True, slots=True, eq=False)
class SensorRecords:
    """All that a run's sensors said; what the craft does not carry is None."""

    epoch_utc: str
    ephemeris: EphemerisData
    gyro: GyroData | None = None
    accelerometer: AccelerometerData | None = None
    gnss: GnssData | None = None
    star_tracker: StarTrackerData | None = None
    keypoints: KeypointData | None = None
    poses: PoseData | None = None
    chaser_ephemeris: EphemerisData | None = None
    """Where the chaser itself is; the filter does not need it, the monitor compares frames and clocks by it."""
    antennas: Antennas | None = None
    """Ends of the GNSS baseline."""


@dataclass(frozen=True, slots=True, eq=False)
class NavState:
    """What the filter believes at one instant."""

    t: float
    status: NavStatus
    r_ric_m: Float[np.ndarray, "3"]
    """Position of the camera relative to the target's origin, the target's RIC frame."""
    v_ric_mps: Float[np.ndarray, "3"]
    """Rate of that position in the rotating RIC frame."""
    q_cam_target: Float[np.ndarray, "wxyz=4"]
    """Attitude of the target in the camera frame."""
    t_cam_target_m: Float[np.ndarray, "3"]
    """The target's origin in the camera frame."""
    rate_target: Float[np.ndarray, "3"]
    """Inertial rate of the target, target axes [rad/s]."""
    gyro_bias: Float[np.ndarray, "3"]
    """Bias of the gyro, camera axes [rad/s]."""
    gnss_bias_m: Float[np.ndarray, "3"]
    """Bias of the relative GNSS position, ECI axes."""
    covariance: Float[np.ndarray, "12 12"]
    """Covariance of the errors, in the blocks of NAV_ERRORS; attitude: q_true = q * exp(theta / 2), target axes."""
    pose_covariance: Float[np.ndarray, "6 6"]
    """Covariance of (dt, dr) of T_cam_target in camera axes, as PoseResult has it."""
    cause: str = ""
    """What makes the state suspect, for people."""

    def __post_init__(self) -> None:
        for f in fields(self)[2:-1]:
            shape = {"q_cam_target": (4,), "covariance": (12, 12), "pose_covariance": (6, 6)}.get(f.name, (3,))
            object.__setattr__(self, f.name, frozen(getattr(self, f.name), shape, f.name))
