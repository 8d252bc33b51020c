"""The relative navigation filter as a module: poses and the chaser's own navigation in, the target's state out."""

import time
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from proxnav.geometry.types import Box, Points, Vector3
from proxnav.live.basilisk.attitude import q_n_b
from proxnav.live.basilisk.camera_config import Mounting, camera_of, mounting_of
from proxnav.live.basilisk.installed import NANO, linked, messaging, sysModel
from proxnav.live.basilisk.relative_messages import Chaser, hill_state, nav_att, nav_trans, small_body, target_state
from proxnav.live.relative_filter import ChaserState, RelativeFilter
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.predicted_measurement import predict_measurement
from proxnav.navigation.readings import PoseFix
from proxnav.records import NavState, NavStatus


class PoseSource(Protocol):
    """A module whose poses the filter takes: `PoseSensor`, `TruePoseSensor`, or one of your own."""

    fixes: list[PoseFix]


class RelativeNavigation(sysModel.SysModel):
    """Filters the poses of a pose sensor along the chaser's flight.

    In: the chaser's own attitude and orbit, as simpleNav writes them (`vehAccumDV` tells the burns), and the camera.
    Out: the target's orbit and attitude, the Hill state of the chaser, and all twelve states with their covariance.
    The target need not tell anything. Nothing is written before the first pose: let control wait for `status`. The
    chaser's centre of mass is taken to be the origin of its body axes.
    """

    def __init__(
        self, poses: PoseSource, points_target_m: Points, config: NavigationConfig | None = None,
        attitude_sigma_rad: float = 5e-5,
    ) -> None:  # fmt: skip
        super().__init__()
        self.ModelTag = "RelativeNavigation"
        self.chaserAttInMsg = messaging.NavAttMsgReader()
        self.chaserTransInMsg = messaging.NavTransMsgReader()
        self.cameraConfigInMsg = messaging.CameraConfigMsgReader()
        self.targetTransOutMsg = messaging.NavTransMsg()
        self.targetAttOutMsg = messaging.NavAttMsg()
        self.hillStateOutMsg = messaging.HillRelStateMsg()
        self.smallBodyOutMsg = messaging.SmallBodyNavMsg()
        self.states: list[NavState] = []
        """What was believed, at each instant that the module ran."""
        self.seconds = 0.0
        """Time spent on filtering."""
        self._poses, self._points_m = poses, points_target_m
        self._config, self._sigma_rad = config or NavigationConfig(), attitude_sigma_rad
        self._filter: RelativeFilter | None = None
        self._taken = 0
        self._gained = np.zeros(3)
        self.gained_mps = 0.0
        """Length of all velocity that thrusters and air gave [m/s]."""

    @property
    def status(self) -> NavStatus:
        """What the last state is worth."""
        return self._filter.status if self._filter is not None else "waiting"

    def expected(self, t: float) -> Box | None:
        """The box [px] in which the target will be seen at `t` [s]; None while nobody knows."""
        state = None if self._filter is None else self._filter.at(t)
        if state is None or state.status not in ("tracking", "coasting"):
            return None
        return predict_measurement(state, self._points_m, camera_of(self.cameraConfigInMsg())).box_xyxy

    def Reset(self, nanos: int) -> None:
        """Checks the wiring and forgets."""
        linked(self, "chaserAttInMsg", "chaserTransInMsg", "cameraConfigInMsg")
        self._filter, self._taken = None, len(self._poses.fixes)
        self._gained = np.array(self.chaserTransInMsg().vehAccumDV)

    def UpdateState(self, nanos: int) -> None:
        """Takes what is new and publishes the state of this instant."""
        began, t = time.perf_counter(), nanos * NANO
        mounting, chaser = self._chaser()
        state = self._filtered(t, mounting, chaser)
        if state is not None:
            self.states.append(state)
            self._publish(state, chaser, nanos)
        self.seconds += time.perf_counter() - began

    def _chaser(self) -> tuple[Mounting, Chaser]:
        attitude, orbit = self.chaserAttInMsg(), self.chaserTransInMsg()
        mounting, q = mounting_of(self.cameraConfigInMsg()), q_n_b(np.array(attitude.sigma_BN))
        rate = np.array(attitude.omega_BN_B)
        return mounting, Chaser(np.array(orbit.r_BN_N), np.array(orbit.v_BN_N), q, rate, mounting)

    def _filtered(self, t: float, mounting: Mounting, chaser: Chaser) -> NavState | None:
        found = self._filter or self._fresh(mounting)
        self._filter = found
        state = ChaserState(
            t, chaser.r_eci_m, chaser.v_eci_mps, mounting.q_eci_cam(chaser.q_eci_body),
            mounting.in_cam(chaser.rate_body), mounting.in_cam(self._burnt()),
        )  # fmt: skip
        found.chaser(state)
        new, self._taken = self._poses.fixes[self._taken :], len(self._poses.fixes)
        for fix in new:
            found.pose(fix)
        return found.at(t)

    def _fresh(self, mounting: Mounting) -> RelativeFilter:
        x, y, z = (-mounting.in_cam(mounting.r_body_cam_m)).tolist()
        config = replace(self._config, geometry=replace(self._config.geometry, chaser_centre_cam_m=(x, y, z)))
        camera = camera_of(self.cameraConfigInMsg())
        return RelativeFilter(self._points_m, camera, config, self._sigma_rad)

    def _burnt(self) -> Vector3:
        """Velocity gained since the last call, body axes [m/s]."""
        total = np.array(self.chaserTransInMsg().vehAccumDV)
        gained, self._gained = total - self._gained, total
        self.gained_mps += float(np.linalg.norm(gained))
        return gained

    def _publish(self, state: NavState, chaser: Chaser, nanos: int) -> None:
        target = target_state(state, chaser)
        messages: tuple[tuple[Any, Any], ...] = (
            (self.targetTransOutMsg, nav_trans(state.t, target)),
            (self.targetAttOutMsg, nav_att(state.t, target, state.rate_target)),
            (self.hillStateOutMsg, hill_state(target)),
            (self.smallBodyOutMsg, small_body(target, state)),
        )
        for message, payload in messages:
            message.write(payload, nanos, self.moduleID)
