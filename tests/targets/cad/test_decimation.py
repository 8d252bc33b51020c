"""Fewer triangles, and the measured bound on what that moves."""

import numpy as np
import pytest
import trimesh

from proxnav.targets.cad import decimation
from proxnav.targets.cad.decimation import decimated, surface_gap
from proxnav.targets.cad.image_tile import Picture
from proxnav.targets.cad.mesh_part import MeshPart
from proxnav.targets.surface.material import Material


def part(mesh: trimesh.Trimesh, picture: Picture | None = None) -> MeshPart:
    return MeshPart("a", np.asarray(mesh.vertices, float), np.asarray(mesh.faces), Material(), picture)


@pytest.fixture
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(decimation, "MOST_TRIANGLES", 2000)


def test_the_gap_between_parallel_plates_is_their_distance() -> None:
    square = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0]], [[0, 0, 0], [1, 1, 0], [0, 1, 0]]])
    assert surface_gap(square, square + np.array([0.0, 0.0, 0.01])) == pytest.approx(0.01, rel=0.01)
    longer = np.concatenate([square, square + np.array([1.0, 0.0, 0.0])])
    assert surface_gap(square, longer) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.usefixtures("few")
def test_a_ball_of_many_triangles_keeps_its_outline_as_promised() -> None:
    said: list[str] = []
    ball = part(trimesh.creation.icosphere(6))  # 81 920 triangles, radius 1 m
    (kept,) = decimated([ball], pixel_m=0.05, say=said.append)
    assert len(kept.faces) <= 2000
    radii = np.linalg.norm(kept.vertices[kept.faces].mean(axis=1), axis=1)
    bound_m = 1e-3 * float(said[-1].split("by more than ")[1].split(" mm")[0])
    assert 0 < 1.0 - radii.min() < bound_m * 1.01
    assert bound_m < 0.01


@pytest.mark.usefixtures("few")
def test_a_camera_that_would_see_the_difference_is_warned_of() -> None:
    ball = part(trimesh.creation.icosphere(5))
    for pixel_m, warned in ((0.05, False), (1e-4, True)):
        said: list[str] = []
        decimated([ball], pixel_m, said.append)
        assert ("decimate it in CAD" in said[-1]) == warned


@pytest.mark.usefixtures("few")
def test_a_soup_of_separate_triangles_stays_closed() -> None:
    """As in STL: no vertex is shared."""
    ball = trimesh.creation.icosphere(5)
    soup = trimesh.Trimesh(
        ball.vertices[ball.faces].reshape(-1, 3), np.arange(3 * len(ball.faces)).reshape(-1, 3), process=False
    )
    (kept,) = decimated([part(soup)], pixel_m=0.05, say=lambda _: None)
    assert trimesh.Trimesh(kept.vertices, kept.faces).is_watertight


@pytest.mark.usefixtures("few")
def test_a_picture_stays_where_it_lies() -> None:
    """A wavy sheet whose texture coordinates are its own x and y."""
    x, y = np.meshgrid(np.linspace(0, 1, 80), np.linspace(0, 1, 80))
    points = np.column_stack([x.ravel(), y.ravel(), 0.02 * np.sin(9 * x.ravel())])
    i = (np.arange(79)[:, None] * 80 + np.arange(79)).ravel()
    faces = np.concatenate([np.column_stack([i, i + 1, i + 81]), np.column_stack([i, i + 81, i + 80])])
    sheet = MeshPart("a", points, faces, Material(), Picture(None, points[faces][..., :2]))
    (kept,) = decimated([sheet], pixel_m=0.05, say=lambda _: None)
    assert len(kept.faces) < 0.5 * len(faces)
    assert kept.picture is not None
    gap = np.abs(kept.picture.corner_uv - kept.vertices[kept.faces][..., :2])
    assert np.percentile(gap, 99) < 0.03


def test_few_triangles_are_left_alone() -> None:
    box = part(trimesh.creation.box((1, 1, 1)))
    assert decimated([box], 0.01, lambda _: None) == [box]
