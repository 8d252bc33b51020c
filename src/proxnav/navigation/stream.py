"""Sensor records as one stream of readings in the order of arrival."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.navigation.filter_setup import FilterSetup
from proxnav.navigation.readings import (
    Acceleration,
    GnssFix,
    GyroReading,
    KeypointFrame,
    PoseFix,
    Reading,
    StarFix,
)
from proxnav.records import (
    AccelerometerData,
    GnssData,
    GyroData,
    KeypointData,
    PoseData,
    SensorRecords,
    StarTrackerData,
)

_LONGEST_FORCE_STEP_S = 2.0
"""A mean force over a longer step says too little about when it acted."""
_ONLY_GYRO_STEP_S = 1.0
"""Step of the only reading of a gyro."""


def readings(records: SensorRecords, setup: FilterSetup) -> list[Reading]:
    """All readings in the order of arrival; of the camera what the coupling uses, poses always for starting."""
    config, found = setup.config, list[Reading]()
    if records.gyro is not None and setup.has_gyro:
        found.extend(_gyro(records.gyro))
    if records.accelerometer is not None and config.accelerometer != "never":
        found.extend(_forces(records.accelerometer))
    if records.star_tracker is not None:
        found.extend(_stars(records.star_tracker))
    if records.gnss is not None and config.gnss:
        found.extend(_gnss(records.gnss))
    if records.poses is not None:
        found.extend(_poses(records.poses))
    if records.keypoints is not None and config.coupling == "tight":
        found.extend(_keypoints(records.keypoints, setup))
    return sorted(found, key=lambda reading: reading.received)


def monitored(records: SensorRecords, setup: FilterSetup) -> list[Reading]:
    """All readings in the order of arrival, with those that only the monitor looks at."""
    found = readings(records, setup)
    if records.keypoints is None or setup.config.coupling == "tight":
        return found
    return sorted([*found, *_keypoints(records.keypoints, setup)], key=lambda reading: reading.received)


def _gyro(data: GyroData) -> Iterator[GyroReading]:
    """Each with its step: the time since the one before, over gaps the usual one."""
    steps = np.diff(data.t)
    usual = float(np.median(steps)) if len(steps) else _ONLY_GYRO_STEP_S
    steps = np.where((steps > 0.0) & (steps < 2.0 * usual), steps, usual).tolist()
    return (GyroReading(*row) for row in zip(data.t.tolist(), data.t.tolist(), data.rate, [usual, *steps], strict=True))


def _forces(data: AccelerometerData) -> Iterator[Acceleration]:
    """Each with the time since the one before; not over gaps."""
    t, thrust = data.t.tolist(), data.thrust.tolist()
    for i in range(1, len(t)):
        step = t[i] - t[i - 1]
        if 0.0 < step < _LONGEST_FORCE_STEP_S:
            yield Acceleration(t[i], t[i], data.specific_force[i], thrust[i], step)


def _stars(data: StarTrackerData) -> Iterator[StarFix]:
    q = quaternion.normalize(data.q_eci_cam)
    for i, (t, received) in _arrivals(data):
        yield StarFix(t, received, q[i], data.sigma_rad[i])


def _gnss(data: GnssData) -> Iterator[GnssFix]:
    sigma_r, sigma_v = data.sigma_position_m.tolist(), data.sigma_velocity_mps.tolist()
    for i, (t, received) in _arrivals(data):
        yield GnssFix(t, received, data.position_m[i], data.velocity_mps[i], sigma_r[i], sigma_v[i])


def _poses(data: PoseData) -> Iterator[PoseFix]:
    q = quaternion.normalize(data.q_cam_target)
    for i, (t, received) in _arrivals(data):
        yield PoseFix(t, received, q[i], data.t_cam_target_m[i], data.covariance[i])


def _keypoints(data: KeypointData, setup: FilterSetup) -> Iterator[KeypointFrame]:
    pixels, cov = straightened(data.pixels, data.covariances_px2, setup)
    for i, (t, received) in _arrivals(data):
        yield KeypointFrame(t, received, pixels[i], cov[i])


def _arrivals(data: StarTrackerData | GnssData | PoseData | KeypointData) -> Iterator[tuple[int, tuple[float, float]]]:
    """(row, (t, received))."""
    return enumerate(zip(data.t.tolist(), data.received.tolist(), strict=True))


def straightened(
    pixels: Float[np.ndarray, "*batch 2"], cov: Float[np.ndarray, "*batch 2 2"], setup: FilterSetup
) -> tuple[Float[np.ndarray, "*batch 2"], Float[np.ndarray, "*batch 2 2"]]:
    """Pixels and covariances of a camera with distortion as one without would have them."""
    camera = setup.real_camera
    if not camera.is_distorted:
        return pixels, cov
    rays = camera.unproject(pixels)
    J_rays = camera.projection_jacobian(rays)[..., :2]
    scale = np.array([[setup.camera.fx], [setup.camera.fy]])
    J = np.linalg.inv(np.where(np.isfinite(J_rays), J_rays, np.eye(2))) * scale
    return setup.camera.project(rays), J @ cov @ np.swapaxes(J, -1, -2)
