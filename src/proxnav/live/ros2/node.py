"""Images in, poses out: the node."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera
from proxnav.geometry.types import Image
from proxnav.live.frame_intake import FrameIntake
from proxnav.live.ros2 import conversions
from proxnav.live.ros2 import messages as ros
from proxnav.live.ros2.camera_rate import CameraRate
from proxnav.live.ros2.health import Health, diagnosis
from proxnav.live.ros2.installed import core, domain
from proxnav.live.ros2.node_config import NodeConfig
from proxnav.live.ros2.topics import reader, writer
from proxnav.live.ros2.twist import MovingPose, TargetTwist, twist_between
from proxnav.records import PoseResult

_REPORT_S = 1.0
_LONGEST_GAP_S = 5.0
"""Two poses farther apart say nothing about a velocity."""
_AT_ONCE = 16


@dataclass(frozen=True, slots=True, eq=False)
class _Frame:
    image: Image
    header: ros.Header
    t: float


@dataclass(slots=True)
class _Answers:
    """The node's writers."""

    pose: Any
    odometry: Any
    tf: Any
    diagnostics: Any


class PoseNode:
    """Answers each image by a pose; of images that wait only the newest is estimated, so latency is bounded.

    >>> node = PoseNode(PoseEstimator.load("space-rider"), NodeConfig())  # doctest: +SKIP
    >>> node.run()                                                        # doctest: +SKIP
    """

    def __init__(self, estimator: PoseEstimator, config: NodeConfig) -> None:
        self.config, self._estimator = config, estimator
        self.health = Health(FrameIntake(config.oldest_s or float("inf")))
        participant = domain.DomainParticipant(config.domain)
        kind = ros.Image if config.image_type == "raw" else ros.CompressedImage
        self._images = reader(participant, config.image, kind, "sensor_data")
        self._infos = reader(participant, config.camera_info, ros.CameraInfo, "sensor_data")
        self._imus = reader(participant, config.imu, ros.Imu, "sensor_data") if config.imu else None
        self._say = _Answers(
            writer(participant, f"{config.prefix}/pose", ros.PoseWithCovarianceStamped, "reliable"),
            writer(participant, f"{config.prefix}/odometry", ros.Odometry, "reliable"),
            writer(participant, "/tf", ros.TFMessage, "tf"),
            writer(participant, "/diagnostics", ros.DiagnosticArray, "reliable"),
        )
        self._arrival = core.WaitSet(participant)
        self._arrival.attach(core.ReadCondition(self._images, core.SampleState.NotRead | core.ViewState.Any))
        self._camera: Camera | None = None
        self._info: ros.CameraInfo | None = None
        self._rate = CameraRate()
        self._before: MovingPose | None = None
        self._reported = -float("inf")

    def run(self, until: Callable[[], bool] = lambda: False) -> None:
        """Answers until told to stop, or interrupted."""
        while not until():
            self.step(0.2)

    def step(self, wait_s: float) -> bool:
        """Waits for images at most so long, answers the newest, and says once a second how it is. Whether one came."""
        self._arrival.wait(round(1e9 * wait_s))
        self._learn_camera()
        self._learn_rate()
        frame = self._newest()
        if frame is not None and self._camera is not None:
            self._answer(frame, self._camera)
        self._report()
        return frame is not None

    def _learn_camera(self) -> None:
        for info in self._infos.take(_AT_ONCE):
            if not isinstance(info, ros.CameraInfo) or _same_calibration(info, self._info):
                continue
            try:
                self._camera, self._info, self.health.calibration = conversions.camera_of(info), info, ""
            except InputError as error:
                self.health.calibration = str(error)

    def _learn_rate(self) -> None:
        for imu in [] if self._imus is None else self._imus.take(256):
            if isinstance(imu, ros.Imu):
                self._rate.take(conversions.seconds(imu.header.stamp), conversions.xyz_of(imu.angular_velocity))

    def _newest(self) -> _Frame | None:
        """The last image that can be used; all others are counted."""
        found: _Frame | None = None
        for message in self._images.take(_AT_ONCE):
            if not isinstance(message, ros.Image | ros.CompressedImage):
                continue
            self.health.heard = time.monotonic()
            if self._camera is None:
                self.health.uncalibrated += 1
                continue
            t = conversions.seconds(message.header.stamp)
            image = self.health.intake.take(
                t, time.time(), self._camera, lambda message=message: conversions.pixels_of(message)
            )
            if image is None:
                continue
            self.health.superseded += found is not None
            found = _Frame(image, self._header(message.header), t)
        return found

    def _header(self, given: ros.Header) -> ros.Header:
        return conversions.header(given.stamp, given.frame_id or self.config.camera_frame)

    def _answer(self, frame: _Frame, camera: Camera) -> None:
        result = self._estimator(frame.image, camera)
        self.health.judged(result.status, time.time() - frame.t)
        if result.T_cam_target is None or result.covariance is None:
            return
        self._say.pose.write(conversions.stamped_pose(result, frame.header))
        transform = conversions.transform_of(result.T_cam_target, frame.header, self.config.target_frame)
        self._say.tf.write(ros.TFMessage([transform]))
        self._say.odometry.write(self._odometry(result, frame))

    def _odometry(self, result: PoseResult, frame: _Frame) -> ros.Odometry:
        assert result.T_cam_target is not None
        assert result.covariance is not None
        now, before = MovingPose(frame.t, result.T_cam_target, result.covariance), self._before
        self._before = now
        said = ros.Odometry(
            frame.header, self.config.target_frame, conversions.pose_of(now.T_cam_target, now.covariance)
        )
        if before is None or not 0.0 < now.t - before.t < _LONGEST_GAP_S:
            said.twist.covariance = (_UNKNOWN * np.eye(6)).ravel().tolist()
            return said
        twist = self._rate.taken_out(twist_between(before, now), before, now)
        said.twist = _twist_message(twist)
        return said

    def _report(self) -> None:
        if time.monotonic() - self._reported < _REPORT_S:
            return
        self._reported = time.monotonic()
        now = round(time.time() * 1e9)
        stamp = ros.Time(now // 10**9, now % 10**9)
        self._say.diagnostics.write(ros.DiagnosticArray(ros.Header(stamp, ""), [diagnosis(self.health, self.config)]))


_UNKNOWN = 1e6
"""Variance of what is not known, as robot_localization writes it."""


def _same_calibration(a: ros.CameraInfo, b: ros.CameraInfo | None) -> bool:
    """Whether only the stamps differ."""
    if b is None:
        return False
    names = ("height", "width", "distortion_model", "d", "k", "binning_x", "binning_y", "roi")
    return all(getattr(a, name) == getattr(b, name) for name in names)


def _twist_message(twist: TargetTwist) -> ros.TwistWithCovariance:
    rates = ros.Twist(conversions.vector_of(twist.linear_mps), conversions.vector_of(twist.angular_radps))
    return ros.TwistWithCovariance(rates, twist.covariance.ravel().tolist())
