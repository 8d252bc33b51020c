"""`proxnav track` on a folder of painted pictures."""

import json

import numpy as np
import pytest

from boxcraft import boxcraft
from painted_box import CAMERA, painted
from proxnav.cli.main import main
from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses, write_poses
from proxnav.errors import InputError
from proxnav.geometry import Pose, quaternion, so3
from proxnav.geometry.camera_files import speed_json
from proxnav.geometry.pose_errors import pose_errors
from proxnav.images.codecs import encode_png
from proxnav.targets.target_files import save_target
from proxnav.tracking import first_pose, timed_images

FIRST = Pose("cam", "target", quaternion.exp(np.array([0.5, -0.7, 0.3])), np.array([0.2, -0.1, 9.0]))


def turned(k: int) -> Pose:
    """The box after k frames."""
    return Pose.from_matrix("cam", "target", so3.exp(k * np.deg2rad([1.0, -2.0, 0.5])) @ FIRST.R, FIRST.t_m)


@pytest.fixture
def folder(tmp_path):
    """Five frames, the fourth of them damaged, the box as a target file, and its pose in the second frame."""
    images = tmp_path / "images"
    images.mkdir()
    for k in range(5):
        (images / f"{k}.png").write_bytes(encode_png(painted(turned(k))) if k != 3 else b"torn")
    (tmp_path / "camera.json").write_text(json.dumps(speed_json(CAMERA)))
    save_target(boxcraft(), tmp_path / "box")
    write_poses(tmp_path / "start.json", [PoseRecord("1.png", turned(1))])
    return tmp_path


def track(folder, *options: str) -> int:
    out = ["--out", str(folder / "poses.json"), "--target", str(folder / "box")]
    return main(["track", str(folder / "images"), *out, *options])


def test_frames_from_the_given_pose_on_are_followed_and_a_damaged_one_is_passed_over(folder, capsys):
    assert track(folder, "--start", str(folder / "start.json"), "--overlays", str(folder / "seen")) == 0
    found = read_poses(folder / "poses.json")
    assert {name: one.status for name, one in found.items()} == {
        "1.png": "ok", "2.png": "ok", "3.png": "bad_image", "4.png": "ok"
    }  # fmt: skip
    for k in (1, 2, 4):
        assert pose_errors(found[f"{k}.png"].T_cam_target, turned(k)).e_c < 0.05
    assert sorted(path.name for path in (folder / "seen").iterdir()) == ["1.png", "2.png", "4.png"]
    assert "3 poses from 4 images" in capsys.readouterr().out


def test_a_pose_as_numbers_begins_with_the_first_image(folder):
    numbers = [f"{x:.6f}" for x in (*FIRST.q_wxyz, *FIRST.t_m)]
    assert track(folder, "--every", "2", "--first-pose", *numbers) == 0
    assert [one.status for one in read_poses(folder / "poses.json").values()] == ["ok"] * 3


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ((), "a track begins with a pose"),
        (("--first-pose", *["1", "0", "0", "0", "0", "0", "9"], "--start", "x.json"), "give one of them"),
        (("--first-pose", *["1", "1", "0", "0", "0", "0", "9"]), "unit quaternion"),
        (("--first-pose", *["1", "0", "0", "0", "0", "0", "9"], "--rate-hz", "0"), "--rate-hz must be positive"),
        (("--first-pose", *["1", "0", "0", "0", "0", "0", "9"], "--start-sigma-deg", "90"), "at most 30"),
        (("--first-pose", *["1", "0", "0", "0", "0", "0", "9"], "--model", "space-rider"), "knows space-rider"),
    ],
)
def test_what_contradicts_is_one_sentence_and_nothing_is_written(folder, capsys, options, says):
    assert track(folder, *options) == 1
    assert says in capsys.readouterr().err
    assert not (folder / "poses.json").exists()


def test_poses_of_other_images_are_refused_and_one_alone_is_that_of_the_first(folder):
    images = timed_images(folder, sorted((folder / "images").iterdir()), 1.0)
    write_poses(folder / "one.json", [PoseRecord("elsewhere.png", FIRST)])
    assert first_pose(folder / "one.json", images)[1] == images
    write_poses(folder / "two.json", [PoseRecord("a.png", FIRST), PoseRecord("b.png", FIRST)])
    with pytest.raises(InputError, match="none of its 2 poses"):
        first_pose(folder / "two.json", images)
