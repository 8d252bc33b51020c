"""The node as a process of its own, asked and read by this one over the loopback."""

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

pytest.importorskip("cyclonedds", reason="Cyclone DDS is not installed: pip install cyclonedds")

from live.ros2.loopback import own_domain, stay_on_loopback
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry import Pose, quaternion
from proxnav.live.ros2 import messages as ros
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.viewing.replay.mcap_export import camera_info

pytestmark = pytest.mark.slow
SIZE = 512
PATIENCE_S = 120.0
"""How long a process may take to start on a busy machine; answers come as fast as they come."""


@dataclass
class Talk:
    """Writers of the questions and readers of the answers."""

    images: Any
    infos: Any
    poses: Any
    odometry: Any
    tf: Any
    diagnostics: Any
    participant: Any

    def calibrate(self) -> None:
        fields = camera_info(CAMERA)
        head = ros.Header(ros.Time(), "cam_optical_frame")
        self.infos.write(ros.CameraInfo(head, **(fields | {"roi": ros.RegionOfInterest()})))

    def show(self, image: np.ndarray, stamp_ns: int) -> None:
        height, width = image.shape
        head = ros.Header(ros.Time(stamp_ns // 10**9, stamp_ns % 10**9), "cam_optical_frame")
        self.images.write(ros.Image(head, height, width, "mono8", 0, width, image.tobytes()))


SCENE = draw_scenes(load_mission("observation-10-100m"), 1, 7, SIZE)[0]
CAMERA = SCENE.camera


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    return FrameJob("space-rider", FrameConfig("raycast"))()(SCENE).image


@contextmanager
def node(domain: int) -> Iterator[subprocess.Popen[str]]:
    command = [sys.executable, "-m", "proxnav.live.ros2", "--domain", str(domain), "--threads", "1", "--silent-s", "1"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        try:
            yield process
        finally:
            process.kill()


@pytest.fixture(scope="module")
def talk() -> Iterator[Talk]:
    from proxnav.live.ros2.installed import domain
    from proxnav.live.ros2.topics import reader, writer

    stay_on_loopback()
    number = own_domain()
    participant = domain.DomainParticipant(number)
    with node(number):
        yield Talk(
            writer(participant, "/camera/image_raw", ros.Image, "reliable"),
            writer(participant, "/camera/camera_info", ros.CameraInfo, "reliable"),
            reader(participant, "/proxnav/pose", ros.PoseWithCovarianceStamped, "reliable"),
            reader(participant, "/proxnav/odometry", ros.Odometry, "reliable"),
            reader(participant, "/tf", ros.TFMessage, "tf"),
            reader(participant, "/diagnostics", ros.DiagnosticArray, "reliable"),
            participant,
        )


def wait(found: Callable[[], Any], again: Callable[[], None] = lambda: None) -> Any:
    """What `found` finds, asked ten times a second; `again` before each time."""
    end = time.monotonic() + PATIENCE_S
    while time.monotonic() < end:
        again()
        time.sleep(0.1)
        if value := found():
            return value
    raise AssertionError("the node never said it")


def counts(talk: Talk) -> dict[str, int]:
    """What the last diagnostics count."""
    last = wait(lambda: talk.diagnostics.take(50))[-1]
    return {value.key: int(value.value) for value in last.status[0].values}


def now_ns() -> int:
    return time.time_ns()


def raw(side: int, content: bytes, stamp_ns: Callable[[], int]) -> Callable[[], ros.Image]:
    """A square image of any content, stamped when it is made."""

    def made() -> ros.Image:
        sec, nanosec = divmod(stamp_ns(), 10**9)
        return ros.Image(ros.Header(ros.Time(sec, nanosec), ""), side, side, "mono8", 0, side, content)

    return made


def test_an_image_is_answered_by_pose_odometry_and_tf(talk: Talk, image: np.ndarray) -> None:
    def ask() -> None:
        talk.calibrate()
        talk.show(image, now_ns())

    answer = wait(lambda: talk.poses.take(1), ask)[0]
    found = answer.pose.pose
    q = np.array([found.orientation.w, found.orientation.x, found.orientation.y, found.orientation.z])
    t = np.array([found.position.x, found.position.y, found.position.z])
    truth = SCENE.T_cam_target
    assert answer.header.frame_id == "cam_optical_frame"
    assert np.linalg.norm(t - truth.t_m) < 0.05 * np.linalg.norm(truth.t_m)
    assert quaternion.angle_between(q, truth.q_wxyz) < np.deg2rad(5.0)
    assert np.linalg.eigvalsh(np.array(answer.pose.covariance).reshape(6, 6)).min() > 0.0
    (transform,) = wait(lambda: talk.tf.take(1))[0].transforms
    moved = transform.transform
    assert (transform.header.frame_id, transform.child_frame_id) == ("cam_optical_frame", "target")
    q_tf = [moved.rotation.w, moved.rotation.x, moved.rotation.y, moved.rotation.z]
    T = Pose.from_wxyz("cam", "target", q_tf, [moved.translation.x, moved.translation.y, moved.translation.z])
    np.testing.assert_allclose(T.t_m, t, atol=1e-9)
    odometry = wait(lambda: talk.odometry.take(1))[0]
    assert (odometry.child_frame_id, odometry.pose.pose.position.z) == ("target", found.position.z)


def test_garbage_is_counted_and_survived(talk: Talk, image: np.ndarray) -> None:
    wait(lambda: talk.poses.take(1), lambda: (talk.calibrate(), talk.show(image, now_ns()))[0])
    before = counts(talk)
    garbage = {
        "empty": raw(SIZE, b"", now_ns),
        "damaged": raw(SIZE, bytes(1000), now_ns),
        "other_size": raw(8, bytes(64), now_ns),
        "stale": raw(SIZE, image.tobytes(), lambda: 10**12),
    }

    def send() -> None:
        for message in garbage.values():
            talk.images.write(message())

    wait(lambda: (found := counts(talk)) and all(found[f"images {k}"] > before[f"images {k}"] for k in garbage), send)
    talk.poses.take(50)
    assert wait(lambda: talk.poses.take(1), lambda: talk.show(image, now_ns()))


def test_a_source_that_dies_is_said_and_when_it_returns_it_is_answered(talk: Talk, image: np.ndarray) -> None:
    from proxnav.live.ros2.topics import writer

    wait(lambda: talk.poses.take(1), lambda: (talk.calibrate(), talk.show(image, now_ns()))[0])
    talk.images = None
    talk.diagnostics.take(50)
    said = wait(lambda: [m for m in talk.diagnostics.take(50) if m.status[0].level == 3])
    assert said[0].status[0].message.startswith("no image on /camera/image_raw for")
    talk.images = writer(talk.participant, "/camera/image_raw", ros.Image, "sensor_data")
    talk.poses.take(50)
    assert wait(lambda: talk.poses.take(1), lambda: talk.show(image, now_ns()))
