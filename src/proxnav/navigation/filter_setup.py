"""What does not change during a run of the filter."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.datasets.sensor_records.plausibility import check_together
from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.calibration import N_CALIBRATION, CalibrationSigma
from proxnav.geometry.types import Points, Rotation3x3, Vector3
from proxnav.navigation.config import CONTROL_DAMPING, NavigationConfig
from proxnav.navigation.gates import frame_gates
from proxnav.navigation.kernels.attitude_control import CONTROL
from proxnav.navigation.kernels.keypoints import LASTING, NEW
from proxnav.navigation.kernels.orbit import orbit_at
from proxnav.navigation.layout import Layout
from proxnav.navigation.process_noise import CAMERA_TAU, noise_vector
from proxnav.records import Antennas, SensorRecords

R_RIC_LVLH = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""LVLH: x along the flight, y against the orbit's normal, z to nadir."""
LONGEST_EPHEMERIS_STEP_S = 120.0


class Ephemeris(NamedTuple):
    """The target's orbit in ECI, at increasing times."""

    t: Float[np.ndarray, "n"]
    r_eci_m: Float[np.ndarray, "n 3"]
    v_eci_mps: Float[np.ndarray, "n 3"]


@dataclass(frozen=True, slots=True, eq=False)
class FilterSetup:
    """Configuration, camera, target and orbit of a run, as the filter's steps take them."""

    config: NavigationConfig
    layout: Layout
    camera: Camera
    """Without distortion: pixels are straightened on entry."""
    real_camera: Camera
    """Its `calibration_sigma` is carried as states that last for the whole flight."""
    sigma_in_poses: CalibrationSigma
    """What of it the covariances of the poses hold already."""
    points_m: Points
    """Keypoints of the target, target axes."""
    ephemeris: Ephemeris
    antennas: Antennas | None
    """Ends of the GNSS baseline; without them no fix of GNSS can be taken."""
    has_gyro: bool
    R_ric_held: Rotation3x3
    """Attitude that a controlled target holds."""
    inertia: Vector3
    """Principal moments of a free target, up to a common factor; zeros where nobody knows."""
    shares: Float[np.ndarray, "2"]
    """Shares of the claimed covariance of keypoints: lasting by themselves, new."""
    noise: Float[np.ndarray, "13"]
    """See `noise_vector`."""
    frame_gates: Float[np.ndarray, "n_dof"]

    @property
    def lens(self) -> Float[np.ndarray, "6"]:
        """fx, fy, cx, cy [px] and the standard deviations of focal length (relative) and principal point [px]."""
        camera, sigma = self.camera, self.camera.calibration_sigma
        return np.array([camera.fx, camera.fy, camera.cx, camera.cy, sigma.focal, sigma.principal_px])

    @property
    def lasting_pose_share(self) -> float:
        """Share of the claimed covariance of a pose that lasts from frame to frame."""
        noise = self.config.noise
        return noise.camera.pose_share if self.config.coupling == "tight" else noise.poses.lasting_share

    @property
    def lasting_tau_s(self) -> float:
        """How long the camera's errors last."""
        return float(self.noise[CAMERA_TAU])

    @property
    def arms_m(self) -> tuple[Vector3, Vector3]:
        """The chaser's antenna in camera axes and the target's in target axes [m]. InputError where nobody says."""
        if self.antennas is None:
            raise InputError(
                "a GNSS fix measures from antenna to antenna, but nobody says where these sit: give antennas, or leave "
                "GNSS out"
            )
        return np.array(self.antennas.chaser_cam_m), np.array(self.antennas.target_target_m)

    def control(self, t: float) -> Float[np.ndarray, "5 3"]:
        """How the target's attitude is controlled at `t`, see `ControlRows`; zeros for a free target."""
        out, config = np.zeros((5, 3)), self.config.held
        if self.config.target == "held":
            _, _, R_eci_ric, rate = self.orbit(t)
            out[CONTROL.R_eci_wanted] = R_eci_ric @ self.R_ric_held
            out[CONTROL.rate] = rate * self.R_ric_held[2]
            out[CONTROL.loop, :2] = config.frequency, CONTROL_DAMPING
        return out

    def orbit(self, t: float) -> tuple[Vector3, Vector3, Rotation3x3, float]:
        """(r [m], v [m/s], R_eci_ric, orbital rate [rad/s]) of the target in ECI."""
        return orbit_at(*self.ephemeris, t)

    def turning(self, t: float, rate_cam: Vector3) -> tuple[Rotation3x3, float, Vector3]:
        """(R_eci_ric, its rate [rad/s], measured rate of the camera [rad/s]) at `t`, as the kernels take them."""
        _, _, R, n = self.orbit(t)
        return R, n, rate_cam

    def R_eci_ric(self, t: float) -> Rotation3x3:
        """Axes of the target's RIC frame at `t`."""
        _, _, R, _ = self.orbit(t)
        return R


def filter_setup(
    ephemeris: Ephemeris, points_m: Points, camera: Camera, config: NavigationConfig, has_gyro: bool,
    sigma_in_poses: CalibrationSigma | None = None, antennas: Antennas | None = None,
) -> FilterSetup:  # fmt: skip
    """What a run needs besides its readings; poses hold what the camera leaves open unless told otherwise.

    InputError where the ephemeris is too coarse.
    """
    n_calibration = 0 if camera.calibration_sigma.is_exact else N_CALIBRATION
    gyro, camera_shares = has_gyro and config.gyro, config.noise.camera
    shares = np.zeros(2)
    shares[LASTING], shares[NEW] = camera_shares.point_share, camera_shares.white_share
    inertia = config.inertia if config.inertia and config.target == "free" else (0.0, 0.0, 0.0)
    points = np.ascontiguousarray(points_m, dtype=np.float64)
    return FilterSetup(
        config=config, layout=Layout(len(points) if config.coupling == "tight" else 0, n_calibration),
        camera=camera.undistorted(), real_camera=camera,
        sigma_in_poses=camera.calibration_sigma if sigma_in_poses is None else sigma_in_poses,
        points_m=points, ephemeris=in_order(ephemeris),
        antennas=config.antennas or antennas, has_gyro=gyro,
        R_ric_held=R_RIC_LVLH @ quaternion.to_matrix(np.array(config.held.q_lvlh_target)), inertia=np.array(inertia),
        shares=shares, noise=noise_vector(config, gyro, n_calibration), frame_gates=frame_gates(2 * len(points)),
    )  # fmt: skip


def setup_of(
    records: SensorRecords, points_m: Points, camera: Camera, config: NavigationConfig,
    sigma_in_poses: CalibrationSigma | None = None,
) -> FilterSetup:  # fmt: skip
    """The setup for a run's records, which are checked against each other first."""
    check_together(records)
    if records.star_tracker is None:
        raise InputError("no star tracker records: the filter needs them to know how the camera is turned")
    if records.keypoints is not None and records.keypoints.pixels.shape[1] > len(points_m):
        raise InputError(
            f"the keypoints number {records.keypoints.pixels.shape[1]} but the target has {len(points_m)}: "
            "give the target whose points the detector finds"
        )
    if records.gnss is not None and config.gnss and not (config.antennas or records.antennas):
        raise InputError(
            "gnss.csv measures from antenna to antenna, but records.json does not say where these sit: add antennas "
            "there, or give --filter.chaser-antenna-cam-m and --filter.target-antenna-target-m, or --filter.no-gnss"
        )
    e = records.ephemeris
    ephemeris = Ephemeris(e.t, e.r_eci_m, e.v_eci_mps)
    has_gyro, antennas = records.gyro is not None, records.antennas
    return filter_setup(ephemeris, points_m, camera, config, has_gyro, sigma_in_poses, antennas)


def in_order(ephemeris: Ephemeris) -> Ephemeris:
    """By time, as compiled code takes it. InputError where its steps are too long."""
    order = np.argsort(ephemeris.t, kind="stable")
    t, r, v = (np.ascontiguousarray(column, dtype=np.float64)[order] for column in ephemeris)
    if len(t) < 2 or not np.diff(t).min() > 0.0 or np.diff(t).max() > LONGEST_EPHEMERIS_STEP_S:
        gap = f"{np.diff(t).max():g} s" if len(t) > 1 else f"{len(t)} row"
        raise InputError(
            f"the ephemeris needs distinct times at most {LONGEST_EPHEMERIS_STEP_S:g} s apart, found {gap}: "
            "give it in smaller steps"
        )
    return Ephemeris(t, r, v)
