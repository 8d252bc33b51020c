"""Keypoints that are suggested, and symmetries that confuse them."""

from pathlib import Path

import numpy as np
import trimesh

from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.keypoints.choice import near_symmetries, seen_share, sharpness
from proxnav.targets.space_rider import space_rider


def test_suggested_keypoints_are_sharp_often_seen_and_apart(glb: Path):
    target = from_mesh(glb, unit_m=1.0)
    assert len(target.keypoint_names) == 24
    assert seen_share(target, target.keypoints_m).min() >= 0.12
    gaps = np.linalg.norm(target.keypoints_m[:, None] - target.keypoints_m[None], axis=2)
    assert gaps[~np.eye(24, dtype=bool)].min() > 0.05  # m
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
