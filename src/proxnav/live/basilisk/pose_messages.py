"""A pose as Basilisk's messages: the target takes the place of the planet, B is the chaser's body."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from proxnav.geometry import quaternion
from proxnav.geometry.perturbation import TRANSLATION
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.live.basilisk.attitude import sigma_bn
from proxnav.live.basilisk.camera_config import Mounting
from proxnav.live.basilisk.installed import messaging
from proxnav.navigation.readings import PoseFix


@dataclass(frozen=True, slots=True, eq=False)
class SeenPose:
    """A pose with what it was seen from."""

    fix: PoseFix
    mounting: Mounting
    q_eci_body: QuatWxyz
    """Attitude of the chaser's body."""

    @property
    def r_target_chaser_cam_m(self) -> Vector3:
        """Origin of the chaser's body from the target's origin, camera axes [m]."""
        return -self.fix.t_cam_target_m - self.mounting.in_cam(self.mounting.r_body_cam_m)

    @property
    def q_eci_target(self) -> QuatWxyz:
        """Attitude of the target."""
        return quaternion.multiply(self.mounting.q_eci_cam(self.q_eci_body), self.fix.q_cam_target)


def op_nav(seen: SeenPose) -> Any:
    """OpNavMsg payload: the chaser's place seen from the target in axes N, B and C, with its covariance in each."""
    r_cam, covariance = seen.r_target_chaser_cam_m, seen.fix.covariance[TRANSLATION, TRANSLATION]
    q_body, q_eci = seen.mounting.q_body_cam, seen.mounting.q_eci_cam(seen.q_eci_body)
    payload = messaging.OpNavMsgPayload()
    payload.timeTag, payload.valid = seen.fix.t, 1
    for axes, q in (("C", quaternion.IDENTITY), ("B", q_body), ("N", q_eci)):
        R = quaternion.to_matrix(np.asarray(q, dtype=np.float64))
        setattr(payload, f"r_BN_{axes}", (R @ r_cam).tolist())
        setattr(payload, f"covar_{axes}", (R @ covariance @ R.T).ravel().tolist())
    return payload


def no_pose(t: float, fault: int) -> Any:
    """OpNavMsg payload of an image without a pose; `fault` 1: the image itself could not be used."""
    payload = messaging.OpNavMsgPayload()
    payload.timeTag, payload.valid, payload.faultDetected = t, 0, fault
    return payload


def target_attitude(seen: SeenPose) -> Any:
    """NavAttMsg payload of the target; its rate is zero, one image does not show it."""
    payload = messaging.NavAttMsgPayload()
    payload.timeTag, payload.sigma_BN = seen.fix.t, sigma_bn(seen.q_eci_target).tolist()
    return payload
