"""The contact sheet, and the command that draws it."""

from pathlib import Path

import cv2
import numpy as np
import pytest
import trimesh

from proxnav.cli.main import main
from proxnav.errors import InputError
from proxnav.targets.loading import load_target
from proxnav.targets.preview import VIEWS, _views, contact_sheet
from proxnav.targets.space_rider import space_rider


def test_sheet_has_a_tile_for_each_view_and_every_tile_shows_the_target():
    sheet = contact_sheet(space_rider(), size_px=160)
    height = _views(space_rider(), 160)[0].height
    assert sheet.shape[1] == 4 * 160
    for i in range(len(VIEWS)):
        row, column = divmod(i, 4)
        tile = sheet[36 + row * height : 36 + (row + 1) * height, column * 160 : (column + 1) * 160]
        assert (tile[20:-20].astype(int).sum(axis=2) > 150).mean() > 0.02


def test_every_view_holds_the_whole_target():
    target = space_rider()
    for view in _views(target, 200):
        px = view.pixels(target.vertices_m)
        assert px.min() >= 0
        assert (px <= [view.width, view.height]).all()


def test_views_show_right_and_down_where_a_pilot_expects_them():
    view = dict(zip((name for name, _, _ in VIEWS), _views(space_rider(), 200), strict=True))
    forward, right, down = np.eye(3) * 3.0
    middle = {name: v.pixels(np.zeros((1, 3)))[0] for name, v in view.items()}

    def shift(name: str, point: np.ndarray) -> np.ndarray:
        return np.sign((view[name].pixels(point[None])[0] - middle[name]).round(6))

    assert shift("from +x", right).tolist() == [-1, 0]
    assert shift("from +y", forward).tolist() == [1, 0]
    assert shift("from +y", down).tolist() == [0, 1]
    assert shift("from -z", forward).tolist() == [0, -1]
    assert shift("from -z", right).tolist() == [1, 0]
    assert shift("from +z", right).tolist() == [-1, 0]


def test_show_prints_the_keypoints_and_writes_the_picture(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "sheet.png"
    assert main(["target", "show", "space-rider", "--out", str(out), "--size", "120"]) == 0
    assert "nose_tip" in capsys.readouterr().out
    picture = cv2.imread(str(out))
    assert picture is not None
    assert picture.shape[1] == 480


def test_new_makes_a_target_that_loads_by_its_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    trimesh.creation.box((1000, 2000, 4000)).subdivide().subdivide().export(tmp_path / "box.stl")
    out = tmp_path / "box"
    assert main(["target", "new", str(tmp_path / "box.stl"), "--unit", "mm", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "turn of 180 deg" in said
    np.testing.assert_allclose(np.ptp(load_target(str(out)).vertices_m, axis=0), [1.0, 2.0, 4.0], atol=1e-5)  # m
    assert (out / "preview.png").is_file()


def test_missing_unit_is_one_sentence(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    trimesh.creation.box((1000, 2000, 4000)).export(tmp_path / "box.stl")
    assert main(["target", "new", str(tmp_path / "box.stl"), "--out", str(tmp_path / "b")]) == 1
    assert capsys.readouterr().err.count("\n") == 1


def test_unknown_unit_is_refused():
    from proxnav.targets.cad.placement import unit_in_metres

    assert unit_in_metres("0.3") == pytest.approx(0.3)
    with pytest.raises(InputError, match="furlong"):
        unit_in_metres("furlong")
