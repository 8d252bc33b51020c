"""`proxnav target`: from a mesh file to a target that every command takes, with what deserves a second look."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from proxnav.cli.main import main
from proxnav.geometry import Camera
from proxnav.pose.solve.best_accuracy import bound_at, ranges_for
from proxnav.targets.cad.placement import unit_in_metres
from proxnav.targets.loading import load_target
from proxnav.targets.space_rider import space_rider


@pytest.fixture
def mesh(tmp_path: Path) -> Path:
    """A slab of 4000 x 1500 x 600 file units."""
    trimesh.creation.box((4000, 1500, 600)).subdivide().subdivide().subdivide().export(tmp_path / "slab.stl")
    return tmp_path / "slab.stl"


def test_a_new_target_is_written_measured_and_looked_at(mesh: Path, tmp_path: Path, capsys) -> None:
    assert main(["target", "new", str(mesh), "--unit", "mm", "--out", str(tmp_path / "slab")]) == 0
    text = capsys.readouterr().out
    assert "4.000 x 1.500 x 0.600 m" in text
    assert "nearly unchanged by a turn of 180 deg" in text
    assert "Cramer-Rao" in text
    assert (tmp_path / "slab" / "preview.png").stat().st_size > 5000
    target = load_target(str(tmp_path / "slab"))
    assert np.ptp(target.vertices_m, axis=0) == pytest.approx([4.0, 1.5, 0.6])


def test_named_keypoints_come_from_a_file_and_a_plane_of_them_is_noticed(mesh: Path, tmp_path: Path, capsys) -> None:
    places = {"a": (-2, -0.7), "b": (-2, 0.7), "c": (2, -0.7), "d": (2, 0.7), "e": (0, 0)}
    rows = [f"{name},{x},{y},-0.3" for name, (x, y) in places.items()]
    (tmp_path / "points.csv").write_text("name,x,y,z\n" + "\n".join(rows))
    words = ["--unit", "mm", "--keypoints", str(tmp_path / "points.csv"), "--out", str(tmp_path / "slab")]
    assert main(["target", "new", str(mesh), *words]) == 0
    assert "nearly in a plane" in capsys.readouterr().out
    assert load_target(str(tmp_path / "slab")).keypoint_names == ("a", "b", "c", "d", "e")


@pytest.mark.parametrize(("answer", "longest"), [("mm", 4.0), ("12.5 m", 12.5), ("0.002", 8.0)])
def test_at_a_terminal_the_unit_is_asked_for(mesh: Path, tmp_path: Path, monkeypatch, capsys, answer, longest) -> None:
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("builtins.input", lambda _: answer)
    assert main(["target", "new", str(mesh), "--out", str(tmp_path / "slab")]) == 0
    assert "mm: 4 m" in capsys.readouterr().out
    assert np.ptp(load_target(str(tmp_path / "slab")).vertices_m, axis=0).max() == pytest.approx(longest)


def test_a_nonsense_answer_is_one_sentence(mesh: Path, tmp_path: Path, monkeypatch, capsys) -> None:
    monkeypatch.setattr("sys.stdin.isatty", lambda: True)
    monkeypatch.setattr("builtins.input", lambda _: "parsec")
    assert main(["target", "new", str(mesh), "--out", str(tmp_path / "slab")]) == 1
    assert "parsec" in capsys.readouterr().err
    assert not (tmp_path / "slab").exists()


def test_without_a_terminal_an_implausible_size_is_refused(mesh: Path, tmp_path: Path, capsys) -> None:
    assert main(["target", "new", str(mesh), "--out", str(tmp_path / "slab")]) == 1
    assert "mm: 4 m" in capsys.readouterr().err


def test_the_bound_grows_with_range_as_geometry_says() -> None:
    """Lateral in proportion to the range, depth with its square, attitude in proportion; half as many pixels: twice."""
    target = space_rider()
    camera = Camera(2048, 2048, 1407.0, 1407.0, 1024.0, 1024.0)
    near, far = bound_at(target, 40.0, camera), bound_at(target, 80.0, camera)
    np.testing.assert_allclose(far[:3] / near[:3], [2.0, 4.0, 2.0], rtol=0.1)
    coarse = bound_at(target, 40.0, camera.resized(1024, 1024))
    np.testing.assert_allclose(coarse[:3] / near[:3], 2.0, rtol=1e-9)


def test_large_craft_are_judged_from_farther_away(mesh: Path, tmp_path: Path) -> None:
    assert main(["target", "new", str(mesh), "--unit", "0.02", "--out", str(tmp_path / "station")]) == 0
    assert ranges_for(load_target(str(tmp_path / "station")))[0] == 50.0
    assert unit_in_metres("ft") == 0.3048
