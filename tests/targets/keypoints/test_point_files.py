"""Keypoints from files."""

import json
from pathlib import Path

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.targets.keypoints.point_files import load_points
from proxnav.targets.named_points import target_points


def test_tango_points_come_from_the_published_mat(shared_data: Path):
    points, names = load_points(shared_data / "speedplus" / "tangoPoints.mat")
    assert points.shape == (11, 3)
    assert names[:2] == ("p00", "p01")
    assert np.abs(points).max() < 1.0  # m


def test_points_from_json_and_csv(tmp_path: Path):
    expected = [[0.0, 0, 0], [1.0, 0, 0], [0.0, 1, 0], [0.0, 0, 1.5]]
    (tmp_path / "a.csv").write_text(
        "name,x,y,z\n" + "".join(f"k{i},{x},{y},{z}\n" for i, (x, y, z) in enumerate(expected))
    )
    (tmp_path / "b.csv").write_text("".join(f"{x},{y},{z}\n" for x, y, z in expected))
    (tmp_path / "c.json").write_text(json.dumps({f"k{i}": p for i, p in enumerate(expected)}))
    (tmp_path / "d.json").write_text(json.dumps({"keypoints_m": expected, "keypoint_names": ["k0", "k1", "k2", "k3"]}))
    for name in ("a.csv", "b.csv", "c.json", "d.json"):
        points, names = load_points(tmp_path / name)
        np.testing.assert_array_equal(points, expected)
        assert names[0] == ("p00" if name == "b.csv" else "k0")


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("a.csv", "1,2,3\n", "4 to"),
        ("a.csv", "1,2\n3,4\n", "x,y,z"),
        ("a.csv", "x,y,z\n1,2,q\n", "triples|numbers"),
        ("a.json", "{", "not JSON"),
        ("a.json", "[[0,0,0],[1,1,1],[2,2,2],[3,3,3]]", "one line"),
        ("a.json", "[[0,0,NaN],[1,0,1],[2,2,2],[3,3,3]]", "not finite"),
        ("a.mat", "text", "not a MATLAB file"),
        ("a.txt", "1,2,3", "found '.txt'"),
    ],
)
def test_bad_point_files_are_refused_in_one_sentence(tmp_path: Path, name: str, text: str, says: str):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError, match=says):
        load_points(tmp_path / name)


@pytest.mark.parametrize(
    ("header", "unit_m"),
    [("x,y,z", 1.0), ("pos_x,pos_y,pos_z", 1.0), ("name,x_mm,y_mm,z_mm", 1e-3), ("name,x [cm],y [cm],z [cm]", 1e-2)],
)
def test_columns_are_read_in_the_unit_that_they_name(tmp_path, header, unit_m):
    numbers = [(10.0, 0.0, 0.0), (0.0, 20.0, 0.0), (0.0, 0.0, 30.0), (10.0, 20.0, 30.0)]
    named = header.startswith("name")
    rows = [",".join([*([f"k{k}"] if named else []), *map(str, row)]) for k, row in enumerate(numbers)]
    path = tmp_path / "points.csv"
    path.write_text("\n".join([header, *rows]))
    np.testing.assert_allclose(load_points(path)[0], unit_m * np.array(numbers))


@pytest.mark.parametrize("header", ["x_km,y_km,z_km", "x_mm,y_mm,z_cm"])
def test_columns_in_another_unit_or_in_several_are_refused(tmp_path, header):
    path = tmp_path / "points.csv"
    path.write_text("\n".join([header, *["1,0,0", "0,1,0", "0,0,1", "1,1,1"]]))
    with pytest.raises(InputError, match="give all in m, mm, cm, in or ft"):
        load_points(path)


def test_points_larger_than_any_spacecraft_are_asked_for_their_unit(tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("\n".join(["x,y,z", *["4020,0,120", "-3325,-5600,-400", "0,5600,0", "1,1,2000"]]))
    with pytest.raises(InputError, match="are they in mm"):
        target_points(str(path))
