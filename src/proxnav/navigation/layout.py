"""Where each quantity lies in the filter's state vector x and in its error vector e, whose covariance is P.

Read them as `x[X.velocity]`, `P[E.velocity, E.velocity]`. Attitudes take four places in x and three in e, so the two
differ behind them. Attitude errors are local: q_true = q * exp(error / 2), in camera axes for q_eci_cam and in target
axes for q_cam_target.

What every filter carries has a fixed place. Compiled code takes X and E for constants: a name costs nothing there.
What only some filters carry lies between that and the pose error, which ends both vectors; `Layout` counts it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import accumulate
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from proxnav.geometry.calibration import N_CALIBRATION

StateVector = Float[np.ndarray, "n_states"]
ErrorVector = Float[np.ndarray, "n_errors"]
Covariance = Float[np.ndarray, "n_errors n_errors"]
PoseCovariance = Float[np.ndarray, "6 6"]
"""Covariance of (dt [m], dr [rad]) of T_cam_target; the axes are in the variable's description."""


class States(NamedTuple):
    """Slices of the state vector x."""

    position: slice
    """Chaser's centre of mass relative to the target's, RIC axes [m]."""
    velocity: slice
    """Rate of that position in the rotating RIC frame [m/s]."""
    q_eci_cam: slice
    q_cam_target: slice
    rate: slice
    """Inertial rate of the target, target axes [rad/s]."""
    gyro_bias: slice
    """Bias of the gyro, camera axes [rad/s]; without gyro minus the camera's rate itself."""
    acceleration: slice
    """Slow relative acceleration (differential drag), RIC axes [m/s^2]."""
    turn_acceleration: slice
    """What Euler's equations leave out of the target's angular acceleration, target axes [rad/s^2]."""
    gnss_bias: slice
    """Slow error of the GNSS baseline, ECI axes [m]."""
    target_centre: slice
    """Centre of mass of the target, target axes [m]."""
    chaser_centre: slice
    """Centre of mass of the chaser, camera axes [m]."""
    misalignment: slice
    """Rotation vector from the camera's axes as they are thought to be to the real ones [rad]."""
    clock: slice
    """By how much frames are stamped later than they were taken [s]."""
    motion: slice
    """Position and velocity."""
    vectors: slice
    """All behind the attitudes, where errors add."""
    camera_errors: slice
    """Lasting errors of the camera: the points' own, those of its calibration, then that of the pose."""
    point_errors: slice
    """Two of each keypoint, in units of their own standard deviation."""
    calibration: slice
    """Errors of the camera's calibration, in units of their own standard deviation; only where some are declared."""
    pose_translation: slice
    """By how much the camera sees the whole target displaced, camera axes [m]."""
    pose_rotation: slice
    """By how much the camera sees the whole target turned, target axes [rad]."""


class Errors(NamedTuple):
    """Slices of the error vector e, and of both axes of P."""

    position: slice
    velocity: slice
    attitude_cam: slice
    """Error of q_eci_cam, camera axes [rad]."""
    attitude: slice
    """Error of q_cam_target, target axes [rad]."""
    rate: slice
    gyro_bias: slice
    acceleration: slice
    turn_acceleration: slice
    gnss_bias: slice
    target_centre: slice
    chaser_centre: slice
    misalignment: slice
    clock: slice
    geometry: slice
    """Centres of mass, misalignment and the camera's clock: constants."""
    motion: slice
    attitudes: slice
    vectors: slice
    core: slice
    """Errors with dynamics of their own."""
    fading: slice
    """Errors behind the core, which only decay."""
    point_errors: slice
    """The points' own, and those of the calibration."""
    calibration: slice
    pose_error: slice
    """Lasting error of the whole pose: translation, then rotation."""


class GeometryErrors(NamedTuple):
    """Slices of the errors `E.geometry` by themselves."""

    target_centre: slice
    chaser_centre: slice
    misalignment: slice
    clock: slice


class FrameColumns(NamedTuple):
    """Columns of H of a frame (a pose, or keypoints): the errors that it sees, the points' own apart."""

    position: slice
    attitude_cam: slice
    attitude: slice
    target_centre: slice
    chaser_centre: slice
    misalignment: slice
    clock: slice
    pose_translation: slice
    pose_rotation: slice
    attitudes: slice
    geometry: slice
    pose_error: slice


class GnssColumns(NamedTuple):
    """Columns of H of a GNSS fix: the errors that it sees."""

    position: slice
    velocity: slice
    attitude_cam: slice
    attitude: slice
    rate: slice
    gyro_bias: slice
    gnss_bias: slice
    target_centre: slice
    chaser_centre: slice


def _in_a_row(*widths: int) -> Iterator[slice]:
    return (slice(stop - width, stop) for width, stop in zip(widths, accumulate(widths), strict=True))


_BEHIND_ATTITUDES = (3, 3, 3, 3, 3, 3, 3, 3, 1)
"""Widths from the target's rate to the camera's clock."""


def _states() -> States:
    r, v, _, q, *_, clock = blocks = tuple(_in_a_row(3, 3, 4, 4, *_BEHIND_ATTITUDES))
    return States(
        *blocks, motion=slice(r.start, v.stop), vectors=slice(q.stop, None), camera_errors=slice(clock.stop, None),
        point_errors=slice(clock.stop, -N_POSE), calibration=_CALIBRATION,
        pose_translation=slice(-N_POSE, -3), pose_rotation=slice(-3, None),
    )  # fmt: skip


def _errors() -> Errors:
    blocks = tuple(_in_a_row(3, 3, 3, 3, *_BEHIND_ATTITUDES))
    r, v, turn_cam, turn, *_, turn_acceleration, _, centre, _, _, clock = blocks
    return Errors(
        *blocks, geometry=slice(centre.start, clock.stop), motion=slice(r.start, v.stop),
        attitudes=slice(turn_cam.start, turn.stop), vectors=slice(turn.stop, None),
        core=slice(r.start, turn_acceleration.stop), fading=slice(turn_acceleration.stop, None),
        point_errors=slice(clock.stop, -N_POSE), calibration=_CALIBRATION, pose_error=slice(-N_POSE, None),
    )  # fmt: skip


def _frame_columns() -> FrameColumns:
    blocks = tuple(_in_a_row(3, 3, 3, 3, 3, 3, 1, 3, 3))
    _, turn_cam, turn, centre, _, _, clock, translation, rotation = blocks
    return FrameColumns(
        *blocks, attitudes=slice(turn_cam.start, turn.stop), geometry=slice(centre.start, clock.stop),
        pose_error=slice(translation.start, rotation.stop),
    )  # fmt: skip


N_POSE = 6
"""Errors of a whole pose, (dt [m], dr [rad])."""
_CALIBRATION = slice(-N_POSE - N_CALIBRATION, -N_POSE)
X, E = _states(), _errors()
FRAME, GNSS = _frame_columns(), GnssColumns(*_in_a_row(3, 3, 3, 3, 3, 3, 3, 3, 3))
GEOMETRY = GeometryErrors(*_in_a_row(3, 3, 3, 1))

N_CORE: int = E.core.stop
N_FIXED: int = E.clock.stop
"""Errors that every filter carries before those of its camera."""
N_GEOMETRY: int = GEOMETRY.clock.stop


@dataclass(frozen=True, slots=True)
class Layout:
    """How long the vectors of one filter are."""

    n_points: int
    """Keypoints that carry lasting errors of their own: all with tight coupling, none with loose."""
    n_calibration: int = 0
    """Errors of the camera's calibration: all or none."""

    @property
    def n_states(self) -> int:
        """Length of x."""
        return X.clock.stop + 2 * self.n_points + self.n_calibration + N_POSE

    @property
    def n_errors(self) -> int:
        """Length of e, and of both axes of P."""
        return N_FIXED + 2 * self.n_points + self.n_calibration + N_POSE

    @property
    def seen_by_pose(self) -> Int[np.ndarray, "n"]:
        """Errors that a pose sees: those of `FRAME`, then those of the calibration."""
        calibration = (E.calibration,) if self.n_calibration else ()
        return self.places(E.position, E.attitudes, E.geometry, E.pose_error, *calibration)

    def places(self, *blocks: slice) -> Int[np.ndarray, "n"]:
        """Places of these blocks in the error vector, one after the other."""
        return np.concatenate([np.arange(self.n_errors)[block] for block in blocks])


_LOOSE = Layout(0)
SEEN_BY_GNSS = _LOOSE.places(E.motion, E.attitudes, E.rate, E.gyro_bias, E.gnss_bias, E.target_centre, E.chaser_centre)
SEEN_BY_STAR_TRACKER = _LOOSE.places(E.attitude_cam)


def diagonal(block: slice) -> tuple[Int[np.ndarray, "n"], Int[np.ndarray, "n"]]:
    """Index of the diagonal of a block of P: `P[diagonal(E.rate)]` are the rate's variances."""
    places = np.arange(block.start, block.stop)
    return places, places
