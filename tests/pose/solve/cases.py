"""Poses, points and pixels for the tests of this room."""

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Camera, Pose, quaternion

CAMERA = Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
FISH = Camera(1920, 1200, 2988.6, 2988.3, 960.0, 600.0, (-0.2238, 0.5141, -6.65e-4, -2.14e-4, -0.1312))
PRISM = Camera(1280, 960, 1820.0, 1822.0, 641.0, 475.0, (-0.12, 0.04, 4e-4, -6e-4, 0.02, 0.05, 0.02, 0.001,
               2e-3, -1e-4, -3e-3, 2e-4))  # fmt: skip
BUBBLE = Camera(1280, 960, 1060.0, 1061.0, 641.0, 475.0, (-0.02, 0.006, -0.004, 0.0008), "fisheye")
SIX = np.array(
    [[3.5, 0.3, 0.2], [-2.6, 0.9, -0.4], [-2.2, -1.0, 0.7], [0.1, 5.4, 0.0], [0.4, -5.6, 0.3], [0.8, 0.2, 1.2]]
)
"""Six points of a stack with two wings [m]."""


def many(count: int = 24) -> Float[np.ndarray, "count 3"]:
    """Points in a box of 8 x 6 x 3 m."""
    return np.random.default_rng(7).uniform(-1.0, 1.0, (count, 3)) * [4.0, 3.0, 1.5]


def random_pose(rng: np.random.Generator, near_m: float = 15.0, far_m: float = 100.0) -> Pose:
    """T_cam_target with any attitude, inside the field of view."""
    z = rng.uniform(near_m, far_m)
    x, y = rng.uniform(-0.12, 0.12, 2) * z
    return Pose.from_wxyz("cam", "target", quaternion.random(rng, 1)[0], [x, y, z])


def turn_between(T: Pose, other: Pose) -> float:
    """Angle [rad] between two attitudes."""
    return float(quaternion.angle_between(T.q_wxyz, other.q_wxyz))
