"""Answers in files: read again they say the same."""

import csv
import json

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose
from proxnav.live.stream.answers import Answer
from proxnav.live.stream.told import told_to
from proxnav.records import PoseResult

CAMERA = Camera(32, 24, 40.0, 40.0, 16.0, 12.0)
IMAGE = np.zeros((24, 32), np.uint8)
POSE = Pose.from_wxyz("cam", "target", [-0.5, 0.5, 0.5, -0.5], [0.1, -0.2, 9.0])
FOUND = Answer("1.png", 1.5, PoseResult("ok", POSE, np.diag(np.arange(1.0, 7.0)), np.zeros(0, bool)), 0.25)
LOST = Answer("2.png", 2.5, PoseResult.failure("lost", 0), 0.1)


def write(path):
    with told_to(path, CAMERA) as tell:
        tell(FOUND, IMAGE)
        tell(LOST, IMAGE)
    return path


def test_json_lines_hold_pose_covariance_and_status(tmp_path):
    found, lost = map(json.loads, write(tmp_path / "a.jsonl").read_text().splitlines())
    assert (found["t"], found["status"], found["q_cam_target"]) == (1.5, "ok", [0.5, -0.5, -0.5, 0.5])
    assert np.diag(found["covariance"]).tolist() == [1, 2, 3, 4, 5, 6]
    assert (lost["status"], lost["t_cam_target_m"]) == ("lost", None)


def test_rows_hold_the_pose_and_leave_empty_what_there_is_not(tmp_path):
    with write(tmp_path / "a.csv").open(newline="") as file:
        found, lost = csv.DictReader(file)
    assert (float(found["t_cam_target_z_m"]), float(found["sigma_ry_rad"])) == (9.0, pytest.approx(5.0**0.5))
    assert (lost["status"], lost["q_cam_target_w"]) == ("lost", "")


def test_mcap_holds_images_and_poses_with_their_stamps(tmp_path):
    decoder = pytest.importorskip("mcap_ros2.decoder", reason="needs the extra view").DecoderFactory()
    from mcap.reader import make_reader

    with write(tmp_path / "a.mcap").open("rb") as file:
        read = list(make_reader(file, decoder_factories=[decoder]).iter_decoded_messages())
    topics = [channel.topic for _, channel, _, _ in read]
    assert topics.count("/camera/image/compressed") == 2
    (pose,) = (message for _, channel, _, message in read if channel.topic == "/target/pose/estimate")
    assert (pose.header.stamp.sec, pose.header.stamp.nanosec) == (2, 500_000_000)
    assert pose.pose.pose.position.z == 9.0
    assert pose.pose.covariance[7] == 2.0


def test_a_file_of_another_kind_is_refused(tmp_path):
    with pytest.raises(InputError, match=r"\.jsonl, \.csv or \.mcap"), told_to(tmp_path / "a.txt", CAMERA):
        pass
