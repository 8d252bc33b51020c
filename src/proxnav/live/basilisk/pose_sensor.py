"""The pose of the target from the camera's images: position as OpNavMsg, attitude as NavAttMsg."""

import time
from collections.abc import Callable

import numpy as np

from proxnav.estimator import PoseEstimator
from proxnav.geometry.types import Box, Vector3
from proxnav.images.codecs import decode_image
from proxnav.live.basilisk.attitude import q_n_b
from proxnav.live.basilisk.camera_config import camera_of, mounting_of
from proxnav.live.basilisk.image_message import image_bytes
from proxnav.live.basilisk.installed import NANO, linked, messaging, sysModel
from proxnav.live.basilisk.pose_messages import SeenPose, no_pose, op_nav, target_attitude
from proxnav.live.frame_intake import FrameIntake
from proxnav.navigation.readings import PoseFix
from proxnav.records import PoseResult, Sky


def anywhere(t: float) -> Box | None:
    """No idea where the target is: the estimator searches the whole image."""
    return None


class PoseSensor(sysModel.SysModel):
    """Estimates the target's pose in each new image of a CameraImageMsg.

    `expected(t)` is the box [px] in which the target is expected, as `RelativeNavigation.expected` knows it; the
    estimator then need not search. Where `chaserAttInMsg` tells the Sun (`vehSunPntBdy`), poses are checked by the view
    that they predict. OpNavMsg holds the chaser's place seen from the target, with its covariance.
    """

    def __init__(self, estimator: PoseEstimator, expected: Callable[[float], Box | None] = anywhere) -> None:
        super().__init__()
        self.ModelTag = "PoseSensor"
        self.imageInMsg = messaging.CameraImageMsgReader()
        self.cameraConfigInMsg = messaging.CameraConfigMsgReader()
        self.chaserAttInMsg = messaging.NavAttMsgReader()
        self.opNavOutMsg = messaging.OpNavMsg()
        self.targetAttOutMsg = messaging.NavAttMsg()
        self.expected = expected
        self.intake = FrameIntake()
        self.result: PoseResult | None = None
        """What the estimator said about the last image that could be read."""
        self.fixes: list[PoseFix] = []
        """All poses, with the covariance of position and attitude together, for which Basilisk has no message."""
        self.seconds = 0.0
        """Time spent on estimating."""
        self._estimator = estimator
        self._seen = -1

    def Reset(self, nanos: int) -> None:
        """Checks the wiring."""
        linked(self, "imageInMsg", "cameraConfigInMsg", "chaserAttInMsg")

    def UpdateState(self, nanos: int) -> None:
        """Reads an image where there is a new one."""
        if not self.imageInMsg.isWritten():
            return
        message = self.imageInMsg()
        if not message.valid or int(self.imageInMsg.timeWritten()) == self._seen:
            return
        self._seen = int(self.imageInMsg.timeWritten())
        config, t, encoded = self.cameraConfigInMsg(), int(message.timeTag) * NANO, image_bytes(message)
        camera = camera_of(config)
        image = self.intake.take(
            t, nanos * NANO, camera, lambda: decode_image(encoded, "CameraImageMsg") if encoded else None
        )
        if image is None:
            self.opNavOutMsg.write(no_pose(t, fault=1), nanos, self.moduleID)
            return
        began, attitude, mounting = time.perf_counter(), self.chaserAttInMsg(), mounting_of(config)
        sun = mounting.in_cam(np.array(attitude.vehSunPntBdy))
        _, self.result = self._estimator.keypoints_and_pose(image, camera, self.expected(t), _sky(sun))
        self.seconds += time.perf_counter() - began
        self._publish(t, nanos, q_n_b(np.array(attitude.sigma_BN)))

    def _publish(self, t: float, nanos: int, q_eci_body: Vector3) -> None:
        result, mounting = self.result, mounting_of(self.cameraConfigInMsg())
        if result is None or result.T_cam_target is None or result.covariance is None:
            self.opNavOutMsg.write(no_pose(t, fault=0), nanos, self.moduleID)
            return
        pose = result.T_cam_target
        fix = PoseFix(t, nanos * NANO, pose.q_wxyz, pose.t_m, result.covariance)
        self.fixes.append(fix)
        seen = SeenPose(fix, mounting, q_eci_body)
        self.opNavOutMsg.write(op_nav(seen), nanos, self.moduleID)
        self.targetAttOutMsg.write(target_attitude(seen), nanos, self.moduleID)


def _sky(sun_cam: Vector3) -> Sky | None:
    """The Sun in camera axes; None where the message holds none."""
    length = float(np.linalg.norm(sun_cam))
    return Sky(sun_cam / length) if length > 0.0 else None
