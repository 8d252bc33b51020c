"""What a replay says of a run: who was where, in one frame, whatever the run's kind."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.errors import InputError
from proxnav.evaluation.run_frames import read_run_frames
from proxnav.geometry import Pose, quaternion, so3
from proxnav.storage.files import write_json
from proxnav.viewing.replay.of_run import read_replay
from proxnav.viewing.replay.replay import position_covariance


def test_frames_json_comes_back_number_by_number(playable: Path) -> None:
    run = read_run_frames(playable)
    assert run is not None
    content = json.loads((playable / "frames.json").read_text())
    assert [frame.t for frame in run.frames] == [0.0, 2.0, 4.0, 6.0, 8.0]
    assert np.isnan(run.frames[0].pixels[0]).all()
    np.testing.assert_allclose(run.frames[0].covariances_px2[1], np.diag([4.0, 1.0]))
    assert content["dataset"] == "set"
    assert run.dataset == (playable / "set").resolve()


def test_a_run_of_images_is_played_in_the_target_frame(playable: Path) -> None:
    replay, poses = read_replay(playable), read_poses(playable / "poses.json")
    assert (replay.world, len(replay.steps), replay.is_sequence) == ("target", 5, True)
    assert replay.steps[1].estimate is None
    for step in (replay.steps[0], replay.steps[4]):
        T = poses[step.label].T_cam_target
        assert T is not None
        assert step.estimate is not None
        np.testing.assert_allclose((step.estimate.T_cam_target @ np.eye(3)), T @ np.eye(3), atol=1e-9)  # m
        np.testing.assert_allclose(step.estimate.T_world_cam.t_m, -T.R.T @ T.t_m, atol=1e-9)


def test_position_covariance_is_that_of_drawn_poses(rng: np.random.Generator) -> None:
    T = Pose.from_wxyz("cam", "target", quaternion.random(rng, 1)[0], [1.0, -2.0, 30.0])
    A = rng.normal(size=(6, 6)) * np.array([0.02, 0.02, 0.2, 0.004, 0.004, 0.004])[:, None]
    draws = rng.normal(size=(20_000, 6)) @ A.T
    places = [-(so3.exp(d[3:]) @ T.R).T @ (T.t_m + d[:3]) for d in draws]
    expected = position_covariance(T, A @ A.T)
    np.testing.assert_allclose(np.cov(np.array(places).T), expected, atol=0.05 * np.trace(expected))


def test_a_flight_is_played_in_ric_and_its_keypoints_fit_its_truth(flight: Path) -> None:
    replay = read_replay(flight)
    assert replay.world == "ric"
    assert replay.target is not None
    for step in replay.steps[2:]:
        assert step.truth is not None
        assert step.pixels is not None
        assert step.errors is not None
        np.testing.assert_allclose(step.truth.T_world_target.t_m, 0.0, atol=1e-6)
        off = replay.camera.project(step.truth.T_cam_target @ replay.keypoints_m) - step.pixels
        assert np.nanmedian(np.linalg.norm(off, axis=1)) < 6.0  # px: noise of the readings and of the star tracker
        assert step.estimate is not None
        true_place = step.truth.T_world_cam.t_m - step.estimate.T_world_cam.t_m
        np.testing.assert_allclose(true_place, step.errors[:3], atol=0.02)  # m: truth is interpolated


def test_every_nth_step(playable: Path) -> None:
    assert [step.t for step in read_replay(playable, every=2).steps] == [0.0, 4.0, 8.0]


def test_a_folder_that_is_no_run_and_a_broken_one_are_one_sentence(playable: Path, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"neither frames\.json"):
        read_replay(tmp_path / "nothing")
    content = json.loads((playable / "frames.json").read_text())
    for key, value in (("camera", 3), ("frames", [{}]), ("keypoints_m", "x"), ("version", 9)):
        write_json(playable / "frames.json", content | {key: value})
        with pytest.raises(InputError):
            read_replay(playable)


def test_images_outside_the_data_set_are_refused(playable: Path) -> None:
    content = json.loads((playable / "frames.json").read_text())
    content["frames"][0]["filename"] = "../../secret.png"
    write_json(playable / "frames.json", content)
    with pytest.raises(InputError, match="leads out of"):
        read_replay(playable)
    write_json(playable / "frames.json", content | {"dataset": "../elsewhere"})
    with pytest.raises(InputError, match="leads out of"):
        read_replay(playable)
