"""`proxnav mission`."""

from pathlib import Path

import cv2

from proxnav.cli.main import main
from proxnav.missions import load_mission

CAMERA = Path(__file__).parents[1] / "data" / "cameras" / "opencv.yaml"


def test_a_new_mission_is_written_read_and_shown(tmp_path: Path, capsys) -> None:
    path = tmp_path / "tour.toml"
    words = ["--target", "space-rider", "--camera", str(CAMERA), "--range-m", "20", "80"]
    assert main(["mission", "new", str(path), *words]) == 0
    assert load_mission(path).name == "tour"
    sheet = tmp_path / "tour.png"
    assert main(["mission", "show", str(path), "--out", str(sheet), "--frames", "2", "--drawn", "6"]) == 0
    assert "keypoints" in capsys.readouterr().out
    assert cv2.imread(str(sheet)).max() > 50


def test_what_is_missing_is_named_where_nobody_can_be_asked(tmp_path: Path, capsys) -> None:
    path = tmp_path / "tour.toml"
    assert main(["mission", "new", str(path), "--target", "space-rider", "--range-m", "20", "80"]) == 1
    assert "--camera is missing" in capsys.readouterr().err
    assert not path.exists()


def test_a_mission_file_is_not_written_over(tmp_path: Path, capsys) -> None:
    path = tmp_path / "tour.toml"
    path.write_text("mine")
    words = ["--target", "space-rider", "--camera", str(CAMERA), "--range-m", "1", "2"]
    assert main(["mission", "new", str(path), *words]) == 1
    assert "another name" in capsys.readouterr().err
    assert path.read_text() == "mine"
