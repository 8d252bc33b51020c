"""The poses for which a craft is easily mistaken: a shape that a half turn leaves nearly unchanged has another one."""

from functools import lru_cache

import numpy as np

from proxnav.geometry import Pose
from proxnav.targets import Target
from proxnav.targets.keypoints.choice import Symmetry, near_symmetries


def rivals(target: Target, T_cam_target: Pose) -> list[Pose]:
    """The pose after each turn that leaves the target's shape nearly unchanged; none for a shape without such turns."""
    R, t = T_cam_target.R, T_cam_target.t_m
    return [Pose.from_matrix("cam", "target", R @ turn.R, t + R @ turn.t_m) for turn in _turns(target)]


@lru_cache(maxsize=8)
def _turns(target: Target) -> tuple[Symmetry, ...]:
    return tuple(near_symmetries(target, np.random.default_rng(0)))
