"""`proxnav estimate` on folders as people have them: damaged pictures, mixed sizes, deep colour."""

import json
import warnings

import numpy as np
import pytest

from proxnav.cli.main import main
from proxnav.datasets.formats import read_pose_records
from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.datasets.image_folders import find_images
from proxnav.errors import InputError, InputNote
from proxnav.estimation import note_other_target
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Camera
from proxnav.geometry.camera_files import speed_json
from proxnav.images.codecs import encode_png
from proxnav.records import Keypoints

CAMERA = Camera(16, 12, 20.0, 20.0, 8.0, 6.0)


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Pictures of three kinds and a damaged one, before a detector that finds nothing."""
    nothing = PoseEstimator(lambda image: Keypoints.none("no_target", 6), np.zeros((6, 3)), ("",) * 6, "x")
    monkeypatch.setattr(PoseEstimator, "load", staticmethod(lambda *_: nothing))
    rng = np.random.default_rng(1)
    for name, shape, most in (("grey", (12, 16), 255), ("colour", (12, 16, 3), 255), ("deep", (12, 16, 3), 65535)):
        image = rng.integers(0, most, shape, dtype=np.uint8 if most == 255 else np.uint16)
        (tmp_path / f"{name}.png").write_bytes(encode_png(image))
    (tmp_path / "torn.png").write_bytes((tmp_path / "grey.png").read_bytes()[:40])
    (tmp_path / "camera.json").write_text(json.dumps(speed_json(CAMERA)))
    return tmp_path


def test_a_damaged_picture_is_a_status_and_not_the_end(folder, capsys):
    assert main(["estimate", str(folder), "--out", str(folder / "poses.json")]) == 0
    statuses = {name: record.status for name, record in read_poses(folder / "poses.json").items()}
    assert statuses == {name: "no_target" for name in ("colour.png", "deep.png", "grey.png")} | {
        "torn.png": "bad_image"
    }
    assert "0 poses from 4 images" in capsys.readouterr().out


def test_pictures_of_other_sizes_are_left_out_and_named(folder, capsys):
    (folder / "large.png").write_bytes(encode_png(np.zeros((20, 20), np.uint8)))
    assert main(["estimate", str(folder), "--out", str(folder / "poses.json")]) == 0
    assert "large.png" not in read_poses(folder / "poses.json")
    assert "1 images are not of the camera's size and are left out: large.png (20x20 px)" in capsys.readouterr().err


def test_a_camera_of_another_size_than_every_picture_is_refused(folder, capsys):
    camera = folder / "other.json"
    camera.write_text(json.dumps(speed_json(Camera(32, 24, 20.0, 20.0, 16.0, 12.0))))
    assert main(["estimate", str(folder), "--camera", str(camera), "--out", str(folder / "poses.json")]) == 1
    assert "no image is of that size" in capsys.readouterr().err
    assert not (folder / "poses.json").exists()


@pytest.mark.parametrize("name", ["flight.avi", "flight.mp4", "FLIGHT.MOV"])
def test_a_video_is_refused_with_what_to_do(name, folder, capsys):
    (folder / "videos").mkdir()
    (folder / "videos" / name).write_bytes(b"RIFF" + bytes(60))
    for source in (folder / "videos" / name, folder / "videos"):
        argv = ["estimate", str(source), "--camera", str(folder / "camera.json"), "--out", str(folder / "p.json")]
        assert main(argv) == 1
        error = capsys.readouterr().err
        assert error.count("\n") == 1
        assert "ffmpeg" in error
    assert not (folder / "p.json").exists()


def test_a_corrupt_picture_alone_is_an_error(folder, capsys):
    (folder / "bad").mkdir()
    half = (folder / "grey.png").read_bytes()[:40]
    for content, found in ((b"not an image", "no readable image"), (half, "none of 1 images can be decoded")):
        (folder / "bad" / "one.png").write_bytes(content)
        argv = ["estimate", str(folder / "bad" / "one.png"), "--camera", str(folder / "camera.json")]
        assert main([*argv, "--out", str(folder / "p.json")]) == 1
        assert found in capsys.readouterr().err
        assert not (folder / "p.json").exists()


def test_a_csv_is_written_where_the_name_says_so_and_read_back(folder, capsys):
    assert main(["estimate", str(folder), "--out", str(folder / "one.csv")]) == 0
    assert (folder / "one.csv").read_text().startswith("filename,status,tx_m,")
    records = read_pose_records(folder / "one.csv")
    assert {name: record.status for name, record in records.items()}["torn.png"] == "bad_image"
    assert main(["estimate", str(folder), "--out", str(folder / "poses.xlsx")]) == 1
    assert "written as .json or .csv" in capsys.readouterr().err


def test_a_run_without_truth_has_overlays_and_a_report(folder, capsys):
    run = folder / "seen"
    assert main(["estimate", str(folder), "--out", str(folder / "p.json"), "--run", str(run)]) == 0
    assert sorted(path.name for path in (run / "overlays").iterdir()) == ["colour.png", "deep.png", "grey.png"]
    assert main(["report", str(run)]) == 0
    page = (run / "report.html").read_text()
    assert page.count("<li><button") == 3
    assert "torn.png</th><td>bad_image</td>" in page
    (run / "truth.json").write_text("[]")
    assert main(["estimate", str(folder), "--out", str(folder / "p.json"), "--run", str(run)]) == 1
    assert "truth is known" in capsys.readouterr().err


def test_an_output_that_cannot_be_written_is_refused_before_the_work(folder, monkeypatch, capsys):
    monkeypatch.setattr("proxnav.estimation.estimate_images", lambda *_: pytest.fail("worked for nothing"))
    assert main(["estimate", str(folder), "--out", str(folder)]) == 1
    assert "is a folder" in capsys.readouterr().err


def test_a_data_set_cannot_name_pictures_outside_itself(folder):
    entry = {
        "image_id": 1, "keypoints": [0, 0, 0], "bbox": [0, 0, 1, 1], "q_cam_target": [1, 0, 0, 0],
        "t_cam_target": [0, 0, 9],
    }  # fmt: skip
    document = {
        "info": {"version": 1}, "categories": [{"keypoints": ["a"]}], "annotations": [entry],
        "images": [{"id": 1, "file_name": "../../secret.png"}],
    }  # fmt: skip
    (folder / "annotations.json").write_text(json.dumps(document))
    with pytest.raises(InputError, match="leads out of"):
        find_images(folder)


def test_a_set_of_another_craft_than_the_model_knows_is_said():
    with pytest.warns(InputNote, match="shows craft, the model knows space-rider"):
        note_other_target("space-rider", "craft")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        note_other_target("space-rider", "space-rider")
