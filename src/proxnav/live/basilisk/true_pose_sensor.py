"""The true pose in place of an estimated one: what a closed loop does when images are not to blame."""

import numpy as np

from proxnav.live.basilisk.attitude import q_n_b
from proxnav.live.basilisk.body_states import true_pose
from proxnav.live.basilisk.camera_config import mounting_of
from proxnav.live.basilisk.installed import NANO, linked, messaging, sysModel
from proxnav.live.basilisk.pose_messages import SeenPose, op_nav, target_attitude
from proxnav.navigation.readings import PoseFix

_SIGMA_M, _SIGMA_RAD = 1e-3, 1e-4
"""What the truth claims, so that a filter stays well conditioned."""


class TruePoseSensor(sysModel.SysModel):
    """Publishes the true pose as `PoseSensor` publishes an estimated one, each time that it runs."""

    def __init__(self) -> None:
        super().__init__()
        self.ModelTag = "TruePoseSensor"
        self.chaserStateInMsg = messaging.SCStatesMsgReader()
        self.targetStateInMsg = messaging.SCStatesMsgReader()
        self.cameraConfigInMsg = messaging.CameraConfigMsgReader()
        self.opNavOutMsg = messaging.OpNavMsg()
        self.targetAttOutMsg = messaging.NavAttMsg()
        self.fixes: list[PoseFix] = []
        """All poses so far."""

    def Reset(self, nanos: int) -> None:
        """Checks the wiring."""
        linked(self, "chaserStateInMsg", "targetStateInMsg", "cameraConfigInMsg")

    def UpdateState(self, nanos: int) -> None:
        """Publishes the pose of this instant."""
        mounting, chaser, t = mounting_of(self.cameraConfigInMsg()), self.chaserStateInMsg(), nanos * NANO
        pose = true_pose(chaser, self.targetStateInMsg(), mounting)
        covariance = np.diag(np.repeat([_SIGMA_M, _SIGMA_RAD], 3) ** 2)
        self.fixes.append(PoseFix(t, t, pose.q_wxyz, pose.t_m, covariance))
        seen = SeenPose(self.fixes[-1], mounting, q_n_b(np.array(chaser.sigma_BN)))
        self.opNavOutMsg.write(op_nav(seen), nanos, self.moduleID)
        self.targetAttOutMsg.write(target_attitude(seen), nanos, self.moduleID)
