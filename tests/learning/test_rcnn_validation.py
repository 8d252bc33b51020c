"""The score that stops a training of Keypoint R-CNN early."""

import numpy as np
import pytest

from proxnav.cli.main import main
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.frames import FrameConfig
from proxnav.geometry import Camera, Pose, so3
from proxnav.learning import rcnn_validation
from proxnav.learning.rcnn_validation import WITHOUT_POSE, Labelled, fresh_frames, mean_e_c
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import Keypoints
from proxnav.rendered_set import render
from proxnav.targets.loading import load_target

CAMERA = Camera(width=256, height=256, fx=350.0, fy=350.0, cx=128.0, cy=128.0)
POINTS = load_target("space-rider").keypoints_m[:8]
NAMES = [f"p{k}" for k in range(8)]


@pytest.fixture
def frames():
    """Two frames, told apart by their only grey level."""
    poses = [Pose.from_matrix("cam", "target", so3.exp(np.array([1.0, k, 0.3])), [0.3, 0.1, 30.0]) for k in (0.1, 0.9)]
    return [Labelled(np.full((256, 256), k, np.uint8), CAMERA, T) for k, T in enumerate(poses)]


@pytest.fixture
def network():
    return object.__new__(KeypointRcnn)


def seen(frames, missed):
    """A detector that finds the true keypoints, in all frames but those in `missed`."""

    def predict(network, image, config):
        k = int(image[0, 0])
        if k in missed:
            return Keypoints.none("no_target", len(POINTS))
        pixels = CAMERA.project(frames[k].T_cam_target @ POINTS)
        return Keypoints(
            "ok", pixels, np.tile(np.eye(2), (len(POINTS), 1, 1)), np.ones(len(POINTS)), np.full(4, np.nan)
        )

    return predict


def test_a_perfect_network_scores_zero_and_a_missed_frame_counts_one(frames, network, monkeypatch):
    validate = mean_e_c(lambda: iter(frames), POINTS, NAMES)
    monkeypatch.setattr(rcnn_validation, "predict", seen(frames, missed=()))
    assert validate(network) == pytest.approx(0.0, abs=1e-6)
    monkeypatch.setattr(rcnn_validation, "predict", seen(frames, missed=(1,)))
    assert validate(network) == pytest.approx(WITHOUT_POSE / 2, abs=1e-6)


def test_frames_are_drawn_once(frames, network, monkeypatch):
    monkeypatch.setattr(rcnn_validation, "predict", seen(frames, missed=()))
    draws = iter([iter(frames)])
    validate = mean_e_c(lambda: next(draws), POINTS, NAMES)
    assert validate(network) == validate(network)


def test_fresh_frames_carry_their_pose():
    (frame,) = fresh_frames(load_mission("observation-10-100m"), 1, 64)
    assert frame.image.shape == (128, 128)
    assert 9.0 < np.linalg.norm(frame.T_cam_target.t_m) < 101.0


def test_a_set_that_is_all_validation_is_refused(tmp_path, capsys):
    scenes = draw_scenes(load_mission("observation-10-100m"), 2, 3, 64)
    render(scenes, FrameConfig("raycast"), tmp_path / "set", 1)
    arguments = ["--out", str(tmp_path / "run"), "--data", str(tmp_path / "set"), "--validation", "2"]
    assert main(["train", "keypoint-rcnn", *arguments]) == 1
    assert "--validation 2 leaves none of the 2 images" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()
