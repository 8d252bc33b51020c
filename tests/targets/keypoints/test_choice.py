"""Keypoints that are suggested, and symmetries that confuse them."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from proxnav.errors import InputError
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.keypoints.choice import near_symmetries, seen_share, suggest_keypoints
from proxnav.targets.keypoints.corners import corner_turn, sharpness
from proxnav.targets.space_rider import space_rider


def test_suggested_keypoints_are_sharp_often_seen_and_apart(glb: Path):
    target = from_mesh(glb, unit_m=1.0)
    n = len(target.keypoint_names)
    assert 16 <= n <= 24  # eight corners of the body and those of the mast that are seen
    assert seen_share(target, target.keypoints_m).min() >= 0.12
    gaps = np.linalg.norm(target.keypoints_m[:, None] - target.keypoints_m[None], axis=2)
    assert gaps[~np.eye(n, dtype=bool)].min() > 0.05  # m
    six = target.with_subset("six").keypoints_m
    assert np.linalg.svd(six - six.mean(axis=0), compute_uv=False)[2] > 0.3  # m, not coplanar


def test_sharpness_of_a_cube_is_that_of_three_faces():
    cube = trimesh.creation.box((1, 1, 1))
    score = sharpness(np.asarray(cube.vertices, float), np.asarray(cube.faces))
    assert score.min() > 0.15
    sphere = trimesh.creation.icosphere(subdivisions=3)
    assert sharpness(np.asarray(sphere.vertices, float), np.asarray(sphere.faces)).max() < 0.02


def test_corners_of_a_thin_plate_are_as_sharp_as_those_of_a_cube():
    """1 - 1/sqrt(3) however the faces are cut into triangles: a corner's three faces each have 90 deg there."""
    for extents in ((0.15, 0.7, 0.01), (0.7, 0.01, 0.15), (1.0, 1.0, 1.0)):  # m
        plate = trimesh.creation.box(extents)
        score = sharpness(np.asarray(plate.vertices, float), np.asarray(plate.faces))
        np.testing.assert_allclose(score, 1.0 - 1.0 / np.sqrt(3.0), atol=1e-9)


def test_symmetry_of_a_plain_box_is_reported_and_space_riders_is_not(tmp_path: Path, rng: np.random.Generator):
    trimesh.creation.box((1, 2, 4)).subdivide().subdivide().export(tmp_path / "box.stl")
    turns = near_symmetries(from_mesh(tmp_path / "box.stl", unit_m=1.0), rng)
    assert sum(turn.angle_deg == 180 for turn in turns) == 3
    assert not near_symmetries(space_rider(), rng)


def test_points_that_can_slide_along_an_edge_or_a_flat_are_no_corners():
    box = trimesh.creation.box((1, 2, 3)).subdivide().subdivide()
    turn = corner_turn(np.asarray(box.vertices, float), np.asarray(box.faces))
    corner = (np.abs(box.vertices) == [0.5, 1.0, 1.5]).all(axis=1)
    assert corner.sum() == 8
    assert turn[corner].min() > 0.1
    assert turn[~corner].max() < 1e-12


@pytest.mark.parametrize("sides", [1, 2])
def test_a_sheet_without_thickness_has_its_corners_on_its_rim(sides: int):
    """Single, or drawn twice for both sides."""
    sheet = (
        trimesh.Trimesh([[0, 0, 0], [4, 0, 0], [4, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]]).subdivide().subdivide()
    )
    faces = np.concatenate([sheet.faces, sheet.faces[:, ::-1]][:sides])
    turn = corner_turn(np.asarray(sheet.vertices, float), faces)
    corner = np.isin(sheet.vertices[:, 0], [0, 4]) & np.isin(sheet.vertices[:, 1], [0, 1])
    assert corner.sum() == 4
    assert turn[corner].min() > 0.1
    assert turn[~corner].max() < 1e-12
    assert sharpness(np.asarray(sheet.vertices, float), faces)[corner].min() > 0.15


def test_a_box_has_eight_keypoints_however_finely_it_is_cut(tmp_path: Path):
    for k in range(2):
        box = trimesh.creation.box((1, 2, 3))
        for _ in range(3 * k):
            box = box.subdivide()
        box.export(tmp_path / f"{k}.stl")
        points = from_mesh(tmp_path / f"{k}.stl", unit_m=1.0).keypoints_m
        np.testing.assert_allclose(np.sort(np.abs(points), axis=0), np.tile([0.5, 1.0, 1.5], (8, 1)), atol=1e-6)


@pytest.mark.parametrize("count", [4, 6, 11])
def test_as_many_as_are_asked_for_are_chosen(count: int):
    points, names = suggest_keypoints(space_rider(), count)
    assert len(points) == len(names) == count


def test_fewer_than_four_are_refused_in_one_sentence(tmp_path: Path):
    with pytest.raises(InputError, match="3 keypoints asked for; a pose needs at least 4"):
        suggest_keypoints(space_rider(), 3)
    plate = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    plate.export(tmp_path / "plate.stl")
    with pytest.raises(InputError, match="only 3 distinct corners"):
        from_mesh(tmp_path / "plate.stl", unit_m=1.0)
