"""How sensors are turned against the camera: their readings in camera axes."""

from dataclasses import dataclass, fields, replace

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.navigation.readings import Acceleration, GyroReading, Reading, StarFix
from proxnav.records.scene import Quadruple

_ALIGNED: Quadruple = (1.0, 0.0, 0.0, 0.0)
_UNIT = 1e-3


@dataclass(frozen=True)
class Mounting:
    """Unit quaternions (w, x, y, z) that take a sensor's axes to the camera's: v_cam = R(q) v_sensor."""

    gyro: Quadruple = _ALIGNED
    accelerometer: Quadruple = _ALIGNED
    star_tracker: Quadruple = _ALIGNED

    def __post_init__(self) -> None:
        for one in fields(self):
            q = getattr(self, one.name)
            if not abs(float(np.linalg.norm(q)) - 1.0) < _UNIT:
                raise InputError(f"mounting: {one.name} needs a unit quaternion w, x, y, z, found {q}")


def in_camera_axes(reading: Reading, mounting: Mounting) -> Reading:
    """The reading as a sensor whose axes are the camera's would give it."""
    match reading:
        case GyroReading() if mounting.gyro != _ALIGNED:
            return replace(reading, rate_cam=quaternion.rotate(_unit(mounting.gyro), reading.rate_cam))
        case Acceleration() if mounting.accelerometer != _ALIGNED:
            turned = quaternion.rotate(_unit(mounting.accelerometer), reading.specific_force)
            return replace(reading, specific_force=turned)
        case StarFix() if mounting.star_tracker != _ALIGNED:
            return _star_fix(reading, _unit(mounting.star_tracker))
        case _:
            return reading


def _star_fix(fix: StarFix, q_cam_tracker: np.ndarray) -> StarFix:
    """The camera's attitude, with its standard deviations about the camera's axes."""
    q_eci_cam = quaternion.multiply(fix.q_eci_cam, quaternion.conjugate(q_cam_tracker))
    variances = np.square(quaternion.to_matrix(q_cam_tracker)) @ np.square(fix.sigma_rad)
    return replace(fix, q_eci_cam=q_eci_cam, sigma_rad=np.sqrt(variances))


def _unit(q: Quadruple) -> np.ndarray:
    return quaternion.normalize(np.array(q))
