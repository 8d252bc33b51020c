"""The filter's state as Basilisk's messages: target and Hill frame for control, all twelve for whoever reads them."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.geometry import quaternion
from proxnav.geometry.celestial import R_eci_ric
from proxnav.geometry.relative_motion import ric_from_eci, ric_rate
from proxnav.geometry.types import Vector3
from proxnav.live.basilisk.attitude import sigma_bn, sigma_by_turn
from proxnav.live.basilisk.camera_config import Mounting
from proxnav.live.basilisk.installed import messaging
from proxnav.records import NavState
from proxnav.records.navigation import NAV_ERRORS


@dataclass(frozen=True, slots=True, eq=False)
class Chaser:
    """The chaser's own navigation at the time of a relative state."""

    r_eci_m: Float[np.ndarray, "3"]
    """Origin of its body axes."""
    v_eci_mps: Float[np.ndarray, "3"]
    q_eci_body: Float[np.ndarray, "wxyz=4"]
    rate_body: Float[np.ndarray, "3"]
    """Inertial rate, body axes [rad/s]."""
    mounting: Mounting


@dataclass(frozen=True, slots=True, eq=False)
class TargetState:
    """The target as the filter believes it, in ECI (Basilisk's N)."""

    r_eci_m: Float[np.ndarray, "3"]
    """Its origin: the chaser's own place less the relative one."""
    v_eci_mps: Float[np.ndarray, "3"]
    q_eci_target: Float[np.ndarray, "wxyz=4"]
    r_hill_m: Float[np.ndarray, "3"]
    """Origin of the chaser's body, Hill frame of the target."""
    v_hill_mps: Float[np.ndarray, "3"]


def target_state(state: NavState, chaser: Chaser) -> TargetState:
    """From the camera's relative state to bodies: the arm of the camera is taken out."""
    r, v, arm = chaser.r_eci_m, chaser.v_eci_mps, chaser.mounting.r_body_cam_m
    R, turn = R_eci_ric(r, v), ric_rate(r, v)
    eye_r = R @ state.r_ric_m
    eye_v = R @ (state.v_ric_mps + np.cross(turn, state.r_ric_m))
    body_r = eye_r - quaternion.rotate(chaser.q_eci_body, arm)
    body_v = eye_v - quaternion.rotate(chaser.q_eci_body, np.cross(chaser.rate_body, arm))
    hill_r, hill_v = ric_from_eci(r - body_r, v - body_v, r, v)
    q = quaternion.multiply(chaser.mounting.q_eci_cam(chaser.q_eci_body), state.q_cam_target)
    return TargetState(r - body_r, v - body_v, q, hill_r, hill_v)


def nav_trans(t: float, target: TargetState) -> Any:
    """NavTransMsg payload of the target."""
    payload = messaging.NavTransMsgPayload()
    payload.timeTag, payload.r_BN_N, payload.v_BN_N = t, target.r_eci_m.tolist(), target.v_eci_mps.tolist()
    return payload


def nav_att(t: float, target: TargetState, rate_target: Vector3) -> Any:
    """NavAttMsg payload of the target, with its rate."""
    payload = messaging.NavAttMsgPayload()
    payload.timeTag, payload.sigma_BN = t, sigma_bn(target.q_eci_target).tolist()
    payload.omega_BN_B = rate_target.tolist()
    return payload


def hill_state(target: TargetState) -> Any:
    """HillRelStateMsg payload: the chaser (deputy) seen from the target (chief)."""
    payload = messaging.HillRelStateMsgPayload()
    payload.r_DC_H, payload.v_DC_H = target.r_hill_m.tolist(), target.v_hill_mps.tolist()
    return payload


def small_body(target: TargetState, state: NavState) -> Any:
    """SmallBodyNavMsg payload, ordered as smallBodyNavEKF's: r, v (Hill), sigma_TN, omega_TN_T of the target T."""
    sigma = sigma_bn(target.q_eci_target)
    payload = messaging.SmallBodyNavMsgPayload()
    payload.state = [*target.r_hill_m, *target.v_hill_mps, *sigma, *state.rate_target]
    payload.covar = _in_mrp(state, sigma).tolist()
    return payload


def _in_mrp(state: NavState, sigma: Vector3) -> Float[np.ndarray, "12 12"]:
    """The covariance with the attitude's errors as those of the parameters."""
    J = np.eye(12)
    J[NAV_ERRORS.attitude, NAV_ERRORS.attitude] = sigma_by_turn(sigma)
    return J @ state.covariance @ J.T
