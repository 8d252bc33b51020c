"""Winding that is repaired, open and crowded meshes that are named."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.cad.soundness import outward, soundness
from proxnav.targets.space_rider import space_rider


def volume(vertices: np.ndarray, faces: np.ndarray) -> float:
    return float(trimesh.Trimesh(vertices, faces, process=False).volume)


@pytest.fixture
def ball() -> trimesh.Trimesh:
    return trimesh.creation.icosphere(subdivisions=3)


def test_a_sound_ball_is_left_as_it_is(ball) -> None:
    faces, turned = outward(ball.vertices, ball.faces)
    assert not turned.any()
    np.testing.assert_array_equal(faces, ball.faces)


def test_an_inverted_ball_is_turned_outward(ball) -> None:
    faces, turned = outward(ball.vertices, ball.faces[:, ::-1])
    assert turned.all()
    assert volume(ball.vertices, faces) > 4.0  # m^3


def test_random_winding_is_made_to_agree(ball, rng) -> None:
    mixed = np.where(rng.random(len(ball.faces))[:, None] < 0.3, ball.faces[:, ::-1], ball.faces)
    assert volume(ball.vertices, outward(ball.vertices, mixed)[0]) == pytest.approx(ball.volume)


def test_an_open_cup_is_turned_by_what_is_seen_from_outside(ball) -> None:
    cup = ball.faces[ball.triangles_center[:, 2] < 0.6]
    assert outward(ball.vertices, cup[:, ::-1])[1].all()
    assert not outward(ball.vertices, cup)[1].any()


def test_a_sheet_has_no_outside_and_stays() -> None:
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    assert not outward(square, np.array([[0, 1, 2], [0, 2, 3]]))[1].any()


def test_our_own_craft_needs_no_repair() -> None:
    target = space_rider()
    assert outward(target.vertices_m, target.faces)[1].mean() < 0.01


def test_open_and_crowded_meshes_are_one_line_each(tmp_path: Path) -> None:
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    sheet = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0, -1, 0]], [[0, 1, 2], [0, 1, 3], [0, 1, 4]])
    scene = trimesh.Scene()
    scene.add_geometry(box, geom_name="box")
    scene.add_geometry(sheet, geom_name="fan")
    scene.export(tmp_path / "a.glb")
    lines = list(soundness(from_mesh(tmp_path / "a.glb", unit_m=1.0)))
    assert len(lines) == 2
    assert "1 of 2 parts are open surfaces, not closed solids (fan)" in lines[0]
    assert "not manifold (fan): more than two triangles meet at 1 edges" in lines[1]


def test_an_inverted_file_is_said_in_one_line(tmp_path: Path, ball) -> None:
    trimesh.Trimesh(ball.vertices, ball.faces[:, ::-1], process=False).export(tmp_path / "a.stl")
    said: list[str] = []
    target = from_mesh(tmp_path / "a.stl", unit_m=1.0, say=said.append)
    assert sum("faced inward and are turned outward" in line for line in said) == 1
    assert volume(target.vertices_m, target.faces) > 4.0
