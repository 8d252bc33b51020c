"""The MCAP file is what ROS 2 and Foxglove expect: read back by the mcap library and by an independent reader."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.viewing.replay.mcap_export import save_mcap
from proxnav.viewing.replay.of_run import read_replay

pytest.importorskip("mcap_ros2", reason="mcap-ros2-support is not installed (pip install 'proxnav[view]')")

EPOCH_S = 1_730_421_000  # 2024-11-01T00:30:00Z
TYPES = {
    "/camera/image/compressed": "sensor_msgs/msg/CompressedImage",
    "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
    "/camera/annotations": "foxglove_msgs/msg/ImageAnnotations",
    "/target/pose/estimate": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/target/pose/truth": "geometry_msgs/msg/PoseStamped",
    "/tf": "tf2_msgs/msg/TFMessage",
}


@pytest.fixture
def exported(playable: Path) -> Path:
    """A run of five frames as MCAP, beside the run."""
    save_mcap(read_replay(playable), playable / "run.mcap")
    return playable / "run.mcap"


def _decoded(path: Path) -> dict[str, list]:
    from mcap.reader import make_reader
    from mcap_ros2.decoder import DecoderFactory

    found: dict[str, list] = {}
    with path.open("rb") as file:
        for schema, channel, message, content in make_reader(
            file, decoder_factories=[DecoderFactory()]
        ).iter_decoded_messages():
            assert schema is not None
            assert schema.name == TYPES[channel.topic]
            found.setdefault(channel.topic, []).append((message.log_time, content))
    return found


def test_every_topic_is_there_at_the_times_of_the_frames(exported: Path) -> None:
    found = _decoded(exported)
    assert set(found) == set(TYPES)
    times = [(stamp / 1e9) - EPOCH_S for stamp, _ in found["/camera/image/compressed"]]
    assert times == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert len(found["/target/pose/estimate"]) == 4  # frame 1 has no pose


def test_poses_and_covariances_are_those_of_poses_json(exported: Path) -> None:
    records = [r for r in read_poses(exported.parent / "poses.json").values() if r.T_cam_target is not None]
    for (_, message), record in zip(_decoded(exported)["/target/pose/estimate"], records, strict=True):
        T, pose = record.T_cam_target, message.pose.pose
        assert T is not None
        assert message.header.frame_id == "camera"
        np.testing.assert_allclose([pose.position.x, pose.position.y, pose.position.z], T.t_m, atol=1e-9)  # m
        q = np.array([pose.orientation.w, pose.orientation.x, pose.orientation.y, pose.orientation.z])
        assert abs(q @ T.q_wxyz) == pytest.approx(1.0, abs=1e-12)
        np.testing.assert_allclose(np.reshape(message.pose.covariance, (6, 6)), record.covariance, rtol=1e-12)


def test_transforms_place_camera_and_target_in_one_world(exported: Path) -> None:
    replay = read_replay(exported.parent)
    _, message = _decoded(exported)["/tf"][0]
    placed = {t.child_frame_id: t.transform.translation for t in message.transforms}
    view = replay.steps[0].truth
    assert view is not None
    assert set(placed) == {"camera", "target", "camera_estimate"}
    camera = placed["camera"]
    np.testing.assert_allclose([camera.x, camera.y, camera.z], view.T_world_cam.t_m, atol=1e-9)  # m


def test_camera_info_has_ros_pixels_and_annotations_have_corner_ones(exported: Path) -> None:
    """ROS counts from the centre of the first pixel, Foxglove's annotations from its corner."""
    replay, found = read_replay(exported.parent), _decoded(exported)
    _, info = found["/camera/camera_info"][0]
    assert (info.width, info.height) == (replay.camera.width, replay.camera.height)
    assert info.k[2] == replay.camera.cx - 0.5
    _, notes = found["/camera/annotations"][0]
    assert replay.steps[0].pixels is not None
    first = replay.steps[0].pixels[1]
    assert (notes.circles[0].position.x, notes.circles[0].position.y) == pytest.approx(tuple(first))


def test_images_are_those_of_the_run(exported: Path) -> None:
    _, message = _decoded(exported)["/camera/image/compressed"][0]
    image = cv2.imdecode(np.frombuffer(message.data, np.uint8), cv2.IMREAD_UNCHANGED)
    original = cv2.imread(str(read_replay(exported.parent).steps[0].image), cv2.IMREAD_UNCHANGED)
    assert image.shape == original.shape
    assert np.corrcoef(image.ravel(), original.ravel())[0, 1] > 0.95


def test_an_independent_reader_of_ros_2_bags_takes_it(exported: Path) -> None:
    highlevel = pytest.importorskip("rosbags.highlevel", reason="rosbags is not installed (pip install rosbags)")
    with highlevel.AnyReader([exported]) as reader:
        assert {c.topic: c.msgtype for c in reader.connections} == TYPES
        read = [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages() if c.topic.endswith("truth")]
    truth = list(read_poses(exported.parent / "truth.json").values())
    assert truth[0].T_cam_target is not None
    assert read[0].pose.position.z == pytest.approx(truth[0].T_cam_target.t_m[2], abs=1e-9)


def test_a_flight_without_images_is_exported_too(flight: Path, tmp_path: Path) -> None:
    save_mcap(read_replay(flight), tmp_path / "flight.mcap")
    assert set(_decoded(tmp_path / "flight.mcap")) == set(TYPES) - {"/camera/image/compressed"}
