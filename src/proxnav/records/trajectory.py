"""Who is where, when: the states of target and chaser, their attitudes and the Sun, in one inertial frame."""

from dataclasses import dataclass, fields

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion
from proxnav.geometry.arrays import frozen
from proxnav.geometry.pointing import phase_angle


@dataclass(frozen=True, slots=True, eq=False)
class Trajectory:
    """States at n instants in ECI (ICRF axes, Earth's centre); `target` is the body frame of the target model."""

    epoch_utc: str
    """ISO 8601 UTC instant of t = 0, for example 2024-11-01T00:00:00Z."""
    t: Float[np.ndarray, "n"]
    """Seconds since the epoch, strictly increasing."""
    r_eci_target_m: Float[np.ndarray, "n 3"]
    """Position of the target frame's origin."""
    v_eci_target_mps: Float[np.ndarray, "n 3"]
    """Inertial velocity of the target."""
    q_eci_target: Float[np.ndarray, "n wxyz=4"]
    """Attitude of the target, wxyz."""
    r_eci_chaser_m: Float[np.ndarray, "n 3"]
    """Position of the camera's projection centre."""
    v_eci_chaser_mps: Float[np.ndarray, "n 3"]
    """Inertial velocity of the chaser."""
    q_eci_cam: Float[np.ndarray, "n wxyz=4"]
    """Attitude of the camera (x right, y down, z forward), wxyz."""
    sun_eci: Float[np.ndarray, "n 3"]
    """Unit vectors from Earth to the Sun."""
    sun_visible: Float[np.ndarray, "n"]
    """Fraction of the Sun's disc that the target sees: 1 in sunlight, 0 in umbra."""
    source: str = "generated"
    """Where it came from: a generator's name or the file names."""

    def __post_init__(self) -> None:
        n = len(self.t)
        widths = {"t": None, "sun_visible": None, "q_eci_target": 4, "q_eci_cam": 4}
        for name in [f.name for f in fields(self)][1:-1]:
            width = widths.get(name, 3)
            shape = (n,) if width is None else (n, width)
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))
        if n == 0 or not np.isfinite(self.t).all() or (np.diff(self.t) <= 0).any():
            raise InputError(f"a trajectory needs at least one finite, strictly increasing time; source {self.source}")

    def __len__(self) -> int:
        return len(self.t)

    @property
    def range_m(self) -> Float[np.ndarray, "n"]:
        """Distance from camera to target [m]."""
        return np.linalg.norm(self.r_eci_target_m - self.r_eci_chaser_m, axis=1)

    @property
    def phase_rad(self) -> Float[np.ndarray, "n"]:
        """Angle Sun, target, camera: 0 with the Sun behind the camera."""
        return np.asarray(phase_angle(self.sun_eci, self.r_eci_chaser_m - self.r_eci_target_m))

    def T_cam_target(self, index: int) -> Pose:
        """Pose of the target in the camera frame at instant `index`."""
        q_cam_eci = quaternion.conjugate(self.q_eci_cam[index])
        t_m = quaternion.rotate(q_cam_eci, self.r_eci_target_m[index] - self.r_eci_chaser_m[index])
        return Pose.from_wxyz("cam", "target", quaternion.multiply(q_cam_eci, self.q_eci_target[index]), t_m)
