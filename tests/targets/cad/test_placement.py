"""The frame of the CAD file, by hand: a lopsided craft in millimetres, its docking port and its centre of mass."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from proxnav.cli.main import main
from proxnav.datasets.formats.speed_poses import read_poses
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.targets.cad.file_frames import FramePlace, frame_places
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.loading import load_target
from step_files import cuboid, write_step

BODY = ((100.0, 200.0, -50.0), (400.0, 500.0, 150.0))
"""Opposite corners in the file [mm]."""
TOWER = ((100.0, 200.0, 150.0), (180.0, 260.0, 350.0))
PORT = (400.0, 350.0, 50.0)
"""Middle of the side at +x."""
CORNERS_M = np.array(
    [[0.1, 0.2, -0.05], [0.4, 0.2, -0.05], [0.1, 0.5, -0.05], [0.4, 0.5, 0.15], [0.18, 0.26, 0.35], [0.1, 0.2, 0.35]]
)
"""Six corners as a CAD program shows them, in metres."""


@pytest.fixture
def stl(tmp_path: Path) -> Path:
    boxes = [trimesh.creation.box(bounds=bounds) for bounds in (BODY, TOWER)]
    trimesh.util.concatenate(boxes).export(tmp_path / "lopsided.stl")
    return tmp_path / "lopsided.stl"


def new(mesh: Path, *words: str) -> Path:
    """The folder of a target made by the command."""
    out = mesh.with_name("craft")
    port = ["--frame", "docking_port=400,350,50,0.7071067811865476,0,0.7071067811865476,0"]
    assert main(["target", "new", str(mesh), "--out", str(out), *port, "--centre-of-mass=240,340,60", *words]) == 0
    return out


def test_coordinates_are_those_of_the_file_in_metres(stl: Path, capsys: pytest.CaptureFixture[str]) -> None:
    target = load_target(str(new(stl, "--unit", "mm")))
    np.testing.assert_allclose(target.vertices_m.min(axis=0), [0.1, 0.2, -0.05], atol=1e-7)
    np.testing.assert_allclose(target.vertices_m.max(axis=0), [0.4, 0.5, 0.35], atol=1e-7)
    np.testing.assert_allclose(target.frames["docking_port"].t_m, [0.4, 0.35, 0.05], atol=1e-12)
    np.testing.assert_allclose(target.frames["docking_port"].R @ [0, 0, 1], [1, 0, 0], atol=1e-12)  # it looks along x
    np.testing.assert_allclose(target.centre_of_mass_m, [0.24, 0.34, 0.06], atol=1e-12)
    assert "origin and axes of the file" in capsys.readouterr().out
    assert main(["target", "show", str(stl.with_name("craft"))]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert "frame docking_port 0.400 0.350 0.050 m q_wxyz 0.707107 0.000000 0.707107 0.000000" in shown
    assert "frame centre_of_mass 0.240 0.340 0.060 m" in shown


def test_every_keypoint_is_a_corner_of_the_file(stl: Path) -> None:
    target = load_target(str(new(stl, "--unit", "mm")))
    corners = 1e-3 * np.array([np.where(bits, b[1], b[0]) for b in (BODY, TOWER) for bits in np.ndindex(2, 2, 2)])
    gap = np.linalg.norm(target.keypoints_m[:, None] - corners[None], axis=2).min(axis=1)
    assert gap.max() < 2e-6  # m


@pytest.mark.parametrize(
    ("origin", "port"), [("box", [0.15, 0.0, -0.1]), ("100,200,-50", [0.3, 0.15, 0.1]), ("file", [0.4, 0.35, 0.05])]
)
def test_another_origin_moves_mesh_and_frames_alike(stl: Path, origin: str, port: list[float]) -> None:
    """The box runs from (100, 200, -50) to (400, 500, 350) mm: its middle is (250, 350, 150)."""
    target = load_target(str(new(stl, "--unit", "mm", f"--origin={origin}")))
    np.testing.assert_allclose(target.frames["docking_port"].t_m, port, atol=1e-7)
    np.testing.assert_allclose(target.vertices_m[:, 0].max(), port[0], atol=1e-7)
    back = target.frames["file"].inverse() @ target.frames["docking_port"]
    np.testing.assert_allclose(back.t_m, [0.4, 0.35, 0.05], atol=1e-7)


def test_axes_turn_mesh_and_frames_alike(stl: Path) -> None:
    """Up z and forward y: forward, right, down are the file's y, x, -z."""
    target = load_target(str(new(stl, "--unit", "mm", "--up", "z", "--forward", "y")))
    np.testing.assert_allclose(target.frames["docking_port"].t_m, [0.35, 0.4, -0.05], atol=1e-12)
    np.testing.assert_allclose(target.frames["docking_port"].R @ [0, 0, 1], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(target.vertices_m.min(axis=0), [0.2, 0.1, -0.35], atol=1e-7)


def test_a_length_scales_frames_too(stl: Path) -> None:
    target = load_target(str(new(stl, "--length-m", "4")))  # 400 mm high: ten times as large
    np.testing.assert_allclose(target.frames["docking_port"].t_m, [4.0, 3.5, 0.5], atol=1e-6)


def test_keypoints_in_the_files_frame_are_brought_along(stl: Path) -> None:
    points = stl.with_name("points.csv")
    points.write_text("\n".join(f"c{i},{x},{y},{z}" for i, (x, y, z) in enumerate(1e3 * CORNERS_M)))
    words = ("--unit", "mm", "--origin", "box", "--keypoints", str(points), "--keypoints-frame", "file")
    target = load_target(str(new(stl, *words)))
    np.testing.assert_allclose(target.keypoints_m, CORNERS_M - [0.25, 0.35, 0.15], atol=1e-9)


def test_a_pose_solved_from_hand_computed_pixels_is_that_of_the_files_origin(stl: Path, monkeypatch) -> None:
    """Camera along +z of the file, its axes the file's, 5 m before (250, 350, 0) mm: pixel = 500 + 1000 x / z."""
    monkeypatch.chdir(stl.parent)
    points = stl.with_name("points.csv")
    points.write_text("\n".join(f"c{i},{x},{y},{z}" for i, (x, y, z) in enumerate(1e3 * CORNERS_M)))
    craft = new(stl, "--unit", "mm", "--keypoints", "points.csv", "--keypoints-frame", "file")
    camera = {"Nu": 1000, "Nv": 1000, "fx": 0.01, "fy": 0.01, "ppx": 1e-5, "ppy": 1e-5, "distCoeffs": [0.0] * 5}
    camera["cameraMatrix"] = [[1000.0, 0, 500], [0, 1000.0, 500], [0, 0, 1]]
    Path("camera.json").write_text(json.dumps(camera))
    x, y, z = (CORNERS_M + np.array([-0.25, -0.35, 5.0])).T
    assert 500 + 1000 * x[0] / z[0] == pytest.approx(469.69697, abs=1e-5)  # -0.15 / 4.95
    row = np.column_stack([500 + 1000 * x / z, 500 + 1000 * y / z, np.ones(6)]).ravel().tolist()
    Path("keypoints.json").write_text(json.dumps([{"file_name": "a.png", "keypoints": row}]))
    command = ["solve", "keypoints.json", "--camera", "camera.json", "--target", str(craft), "--out", "poses.json"]
    assert main(command) == 0
    pose = read_poses(Path("poses.json"))["a.png"].T_cam_target
    assert pose is not None
    np.testing.assert_allclose(pose.t_m, [-0.25, -0.35, 5.0], atol=1e-6)
    np.testing.assert_allclose(pose.R, np.eye(3), atol=1e-6)
    port = pose @ load_target(str(craft)).frames["docking_port"]
    np.testing.assert_allclose(port.t_m, [0.15, 0.0, 5.05], atol=1e-6)
    assert main(["convert", "poses.json", "--from", "poses", "--to", "spec2019", "--out", "sent"]) == 0
    (row,) = next(Path("sent").rglob("*.csv")).read_text().splitlines()
    numbers = [float(cell) for cell in row.split(",")[1:]]
    np.testing.assert_allclose(np.abs(numbers[0]), 1.0, atol=1e-6)  # scalar first
    np.testing.assert_allclose(numbers[4:], [-0.25, -0.35, 5.0], atol=1e-5)


def test_rendered_labels_and_pixels_are_those_of_the_files_corners(stl: Path) -> None:
    """Every label is the projection of the file's own corner, and the drawn craft covers its projected box."""
    craft, out = new(stl, "--unit", "mm"), stl.with_name("set")
    small = ["--frames", "2", "--size", "128", "--renderer", "raycast", "--seed", "4", "--out", str(out)]
    assert main(["render", "--target", str(craft), *small]) == 0
    dataset, target = Dataset(out), load_target(str(craft))
    corners = 1e-3 * np.array([np.where(bits, b[1], b[0]) for b in (BODY, TOWER) for bits in np.ndindex(2, 2, 2)])
    for index, label in enumerate(dataset.labels):
        drawn = dataset.camera.project(label.T_cam_target @ target.keypoints_m)
        np.testing.assert_allclose(label.keypoints_px, drawn, atol=1e-6)
        box = dataset.camera.project(label.T_cam_target @ corners)
        rows, columns = np.nonzero(dataset.mask(index))
        assert abs(columns.min() - box[:, 0].min()) < 1.5
        assert abs(columns.max() + 1 - box[:, 0].max()) < 1.5
        assert abs(rows.min() - box[:, 1].min()) < 1.5


def test_a_step_file_is_in_the_frame_of_its_cad_program(tmp_path: Path) -> None:
    step = write_step(tmp_path / "lopsided.step", [cuboid("b", *BODY, (0.5,) * 3), cuboid("t", *TOWER, (0.9,) * 3)])
    target = from_mesh(step, frames={"port": FramePlace(PORT)}, origin="100,200,-50")
    np.testing.assert_allclose(target.vertices_m.min(axis=0), [0, 0, 0], atol=1e-7)
    np.testing.assert_allclose(target.vertices_m.max(axis=0), [0.3, 0.3, 0.4], atol=1e-7)
    np.testing.assert_allclose(target.frames["port"].t_m, [0.3, 0.15, 0.1], atol=1e-9)


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["--origin", "middle"], "--origin middle: expected"),
        (["--frame", "port=1,2"], "--frame port=1,2: expected X,Y,Z"),
        (["--frame", "port=0,0,0,1,1,0,0"], "norm 1.414"),
        (["--frame", "cam=0,0,0"], "'cam' cannot name a frame"),
        (["--frame", "a=0,0,0", "a=1,1,1"], "given twice"),
        (["--centre-of-mass", "0,0,nan"], "expected X,Y,Z"),
        (["--count", "3"], "at least 4"),
    ],
)
def test_what_cannot_be_placed_is_one_sentence(stl: Path, words: list[str], says: str, capsys) -> None:
    assert main(["target", "new", str(stl), "--unit", "mm", "--out", str(stl.with_name("craft")), *words]) == 1
    said = capsys.readouterr().err
    assert says in said
    assert said.count("\n") == 1
    assert not stl.with_name("craft").exists()


def test_a_target_without_a_centre_of_mass_says_so(stl: Path) -> None:
    with pytest.raises(InputError, match="--centre-of-mass"):
        _ = from_mesh(stl, unit_m=1e-3).centre_of_mass_m


def test_frames_come_from_files(tmp_path: Path) -> None:
    (tmp_path / "a.json").write_text('{"port": [1, 2, 3], "star_tracker": [0, 0, 1, 0, 0, 0, 1]}')
    (tmp_path / "b.csv").write_text("name,x,y,z\ngrapple,4,5,6\n")
    places = frame_places([str(tmp_path / "a.json"), str(tmp_path / "b.csv"), "nose=0,0,9"])
    assert places["port"] == FramePlace((1.0, 2.0, 3.0))
    assert places["star_tracker"].q_wxyz == (0.0, 0.0, 0.0, 1.0)
    assert places["grapple"].r == (4.0, 5.0, 6.0)
    assert places["nose"].r == (0.0, 0.0, 9.0)


def test_an_origin_far_from_the_craft_is_noticed(stl: Path, capsys: pytest.CaptureFixture[str]) -> None:
    new(stl, "--unit", "mm", "--origin=5000,0,0")
    assert "origin lies 4.60 m outside the mesh" in capsys.readouterr().out
