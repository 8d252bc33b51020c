"""States of craft and cameras from Basilisk's SCStatesMsg."""

from typing import Any

import numpy as np

from proxnav.geometry import Pose, quaternion
from proxnav.geometry.types import Vector3
from proxnav.live.basilisk.attitude import q_n_b
from proxnav.live.basilisk.camera_config import Mounting
from proxnav.scenes.from_states import CraftState

_AT_ORIGIN = np.zeros(3)


def craft_state(states: Any, arm_body_m: Vector3 = _AT_ORIGIN) -> CraftState:
    """State of a point of a body, with the body's attitude; the origin of the body axes unless an arm leads from it."""
    q, rate = q_n_b(np.array(states.sigma_BN)), np.array(states.omega_BN_B)
    r = np.array(states.r_BN_N) + quaternion.rotate(q, arm_body_m)
    return CraftState(r, np.array(states.v_BN_N) + quaternion.rotate(q, np.cross(rate, arm_body_m)), q)


def camera_state(chaser_states: Any, mounting: Mounting) -> CraftState:
    """State of the camera, with its own attitude."""
    eye = craft_state(chaser_states, mounting.r_body_cam_m)
    return CraftState(eye.r_eci_m, eye.v_eci_mps, mounting.q_eci_cam(eye.q_eci_body))


def true_pose(chaser_states: Any, target_states: Any, mounting: Mounting) -> Pose:
    """T_cam_target as it is."""
    eye, target = camera_state(chaser_states, mounting), craft_state(target_states)
    back = quaternion.conjugate(eye.q_eci_body)
    t_m = quaternion.rotate(back, target.r_eci_m - eye.r_eci_m)
    return Pose.from_wxyz("cam", "target", quaternion.multiply(back, target.q_eci_body), t_m)
