"""`proxnav solve` on files."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from proxnav.cli.main import main
from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.camera_files import speed_json

CAMERA = Camera(1920, 1200, 2988.6, 2988.3, 960.0, 600.0, (-0.2238, 0.5141, -6.65e-4, -2.14e-4, -0.1312))
POINTS = np.random.default_rng(3).uniform(-1.0, 1.0, (9, 3)) * [2.0, 1.0, 1.0]


@pytest.fixture
def work(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with camera.json, points.json and keypoints.json of four images."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "camera.json").write_text(json.dumps(speed_json(CAMERA)))
    (tmp_path / "points.json").write_text(json.dumps(POINTS.tolist()))
    (tmp_path / "keypoints.json").write_text(json.dumps([result(k) for k in range(4)]))
    return tmp_path


def true_pose(k: int) -> Pose:
    return Pose.from_wxyz("cam", "target", quaternion.random(np.random.default_rng(k), 1)[0], [0.1 * k, -0.2, 12.0 + k])


def result(k: int, **extra: Any) -> dict[str, Any]:
    pixels = CAMERA.project(true_pose(k) @ POINTS)
    return {"file_name": f"img{k}.png", "keypoints": np.c_[pixels, np.ones(9)].ravel().tolist()} | extra


def solve(*extra: str) -> int:
    argv = ["solve", "keypoints.json", "--camera", "camera.json", "--target", "points.json", "--out", "poses.json"]
    return main([*argv, *extra])


def assert_solved(path: Path, names: list[str], metres: float = 1e-6) -> None:
    poses = read_poses(path)
    assert list(poses) == names
    for k, record in enumerate(poses.values()):
        assert record.T_cam_target is not None
        assert np.linalg.norm(record.T_cam_target.t_m - true_pose(k).t_m) < metres
        assert quaternion.angle_between(record.T_cam_target.q_wxyz, true_pose(k).q_wxyz) < metres
        assert record.covariance is not None
        assert np.linalg.eigvalsh(record.covariance).min() > 0.0


def test_keypoints_become_poses_with_covariance(work: Path, capsys: pytest.CaptureFixture) -> None:
    assert solve() == 0
    assert_solved(work / "poses.json", [f"img{k}.png" for k in range(4)])
    assert "4 poses from 4 images" in capsys.readouterr().out
    entry = json.loads((work / "poses.json").read_text())[0]
    assert set(entry) == {"filename", "q_vbs2tango_true", "r_Vo2To_vbs_true", "status", "covariance"}


def test_poses_go_straight_into_evaluate(work: Path, capsys: pytest.CaptureFixture) -> None:
    solve()
    capsys.readouterr()
    assert main(["evaluate", "poses.json", "poses.json", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["poses"] == 4


def test_covariances_are_used(work: Path) -> None:
    tight = [result(k, covariances_px2=np.tile(0.01 * np.eye(2), (9, 1, 1)).tolist()) for k in range(4)]
    solve()
    loose = read_poses(work / "poses.json")["img0.png"].covariance
    (work / "keypoints.json").write_text(json.dumps(tight))
    assert solve() == 0
    found = read_poses(work / "poses.json")["img0.png"].covariance
    assert loose is not None
    np.testing.assert_allclose(found, 0.01 * loose, rtol=1e-3)


def test_coco_document_names_its_images_and_the_best_detection_counts(work: Path) -> None:
    junk = {"image_id": 7, "score": 0.1, "keypoints": [5.0, 5.0, 1.0] * 9}
    good = {"image_id": 7, "score": 0.9, "keypoints": result(0)["keypoints"]}
    document = {"images": [{"id": 7, "file_name": "seven.png"}], "annotations": [junk, good, junk]}
    (work / "keypoints.json").write_text(json.dumps(document))
    assert solve() == 0
    assert_solved(work / "poses.json", ["seven.png"])


def test_pixel_centre_origin_is_moved_by_half_a_pixel(work: Path) -> None:
    shifted = result(0)
    shifted["keypoints"] = (np.reshape(shifted["keypoints"], (9, 3)) - [0.5, 0.5, 0.0]).ravel().tolist()
    (work / "keypoints.json").write_text(json.dumps([shifted]))
    assert solve("--pixel-origin", "centre") == 0
    assert_solved(work / "poses.json", ["img0.png"])


def test_images_without_enough_keypoints_keep_their_place_and_status(work: Path) -> None:
    blind = result(1)
    blind["keypoints"] = [0.0, 0.0, 0.0] * 6 + blind["keypoints"][18:]
    nulls = result(2)
    nulls["keypoints"][0] = nulls["keypoints"][1] = None
    (work / "keypoints.json").write_text(json.dumps([result(0), blind, nulls]))
    assert solve() == 0
    poses = read_poses(work / "poses.json")
    assert [r.status for r in poses.values()] == ["ok", "too_few_points", "ok"]
    assert poses["img1.png"].T_cam_target is None


def test_points_of_a_mat_file_in_columns(work: Path, shared_data: Path) -> None:
    mat = shared_data / "speedplus" / "tangoPoints.mat"
    from proxnav.targets.named_points import target_points

    points = target_points(str(mat))
    assert points.shape == (11, 3)
    pixels = CAMERA.project(true_pose(0) @ points)
    entry = {"image_id": 3, "keypoints": np.c_[pixels, np.ones(11)].ravel().tolist()}
    (work / "keypoints.json").write_text(json.dumps([entry]))
    assert solve("--target", str(mat)) == 0
    assert_solved(work / "poses.json", ["3"])


def test_a_named_target_and_its_subset(work: Path) -> None:
    from proxnav.targets.named_points import target_points

    assert target_points("space-rider").shape == (24, 3)
    assert target_points("space-rider", "six").shape == (6, 3)


@pytest.mark.parametrize(
    ("content", "fragment"),
    [
        ("nonsense", "not readable as JSON"),
        ("{}", "expected COCO keypoint results"),
        ("[]", "holds no keypoints"),
        ("[3]", "entry 0: needs keypoints"),
        ('[{"image_id": 1}]', "needs keypoints and image_id or file_name"),
        ('[{"image_id": 1, "keypoints": [1, 2]}]', "needs [x, y, score] * n"),
        ('[{"image_id": 1, "keypoints": [1, 2, "a"]}]', "must be numbers"),
        ('[{"image_id": 1, "keypoints": [1, 2, 1]}]', "has 1 keypoints but target points.json has 9"),
        ('[{"image_id": 1, "keypoints": [1, 2, 1], "covariances_px2": [1, 2]}]', "one 2x2 matrix for each of 1"),
    ],
)
def test_unusable_keypoints_are_one_sentence_and_nothing_is_written(
    content: str, fragment: str, work: Path, capsys: pytest.CaptureFixture
) -> None:
    (work / "keypoints.json").write_text(content)
    assert solve() == 1
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "keypoints.json" in error
    assert fragment in error
    assert not (work / "poses.json").exists()


def test_a_camera_without_a_key_is_one_sentence(work: Path, capsys: pytest.CaptureFixture) -> None:
    (work / "camera.json").write_text('{"Nu": 3}')
    assert solve() == 1
    assert "camera.json" in capsys.readouterr().err


@pytest.mark.parametrize(
    "entry", [{"image_id": [1], "keypoints": [1, 2, 1]}, {"image_id": 1, "keypoints": [10**400] * 3}]
)
def test_entries_of_impossible_kinds_are_one_sentence(work: Path, entry: dict, capsys: pytest.CaptureFixture):
    (work / "keypoints.json").write_text(json.dumps([entry]))
    assert solve() == 1
    assert "entry 0" in capsys.readouterr().err


@pytest.mark.parametrize("content", ["5", '{"keypoints_m": 7}', '{"points": [[0, 0, 1e999]], "names": 3}', "[[1, 2]]"])
def test_files_that_hold_no_points_are_one_sentence(work: Path, content: str, capsys: pytest.CaptureFixture):
    (work / "points.json").write_text(content)
    assert solve() == 1
    error = capsys.readouterr().err
    assert "points.json" in error
    assert len(error.splitlines()) == 1


def test_keypoints_that_give_no_pose_anywhere_end_with_a_status_of_their_own(work: Path, capsys):
    exchanged = [result(k) for k in range(3)]
    for one in exchanged:
        xys = np.array(one["keypoints"]).reshape(-1, 3)
        one["keypoints"] = xys[:, [1, 0, 2]].ravel().tolist()
    (work / "keypoints.json").write_text(json.dumps(exchanged))
    assert solve() == 3
    assert "0 poses from 3 images" in capsys.readouterr().out
    assert "ok" not in {one["status"] for one in json.loads((work / "poses.json").read_text())}
    (work / "keypoints.json").write_text(json.dumps([*exchanged, result(3)]))
    assert solve() == 0
