"""Weak keypoints are named: in a plane, on one end, off the mesh, never seen, or taken for one another."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from proxnav.targets.cad.from_mesh import from_mesh, with_keypoints
from proxnav.targets.keypoints.choice import near_symmetries
from proxnav.targets.keypoints.quality import complaints, flatness, mistaken
from proxnav.targets.space_rider import space_rider
from proxnav.targets.target import Target


@pytest.fixture
def box(tmp_path: Path) -> Target:
    """6 x 2 x 1 m about the origin, corners as keypoints."""
    trimesh.creation.box((6, 2, 1)).subdivide().subdivide().export(tmp_path / "box.stl")
    target = from_mesh(tmp_path / "box.stl", unit_m=1.0, up="z", forward="x")
    return with_keypoints(target, corners(), tuple(f"c{k}" for k in range(8)))


def corners() -> np.ndarray:
    """(8, 3) of the box."""
    return np.array([[x, y, z] for x in (-3.0, 3.0) for y in (-1.0, 1.0) for z in (-0.5, 0.5)])


def test_good_keypoints_raise_no_complaint() -> None:
    assert list(complaints(space_rider())) == []


def test_flatness_is_0_in_a_plane_and_1_for_a_cube(rng: np.random.Generator) -> None:
    plane = rng.normal(size=(10, 3)) * (1.0, 2.0, 0.0)
    assert flatness(plane + np.array([0.0, 0.0, 4.0])) == pytest.approx(0.0, abs=1e-12)
    assert flatness(corners() / (3.0, 1.0, 0.5)) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("move", "says"),
    [
        (lambda p: p * (1.0, 1.0, 0.0) + (0.0, 0.0, 0.5), "nearly in a plane"),
        (lambda p: p * (0.3, 1.0, 1.0) + (2.1, 0.0, 0.0), "span 1.80 m of 6.00 m"),
        (lambda p: p * 100.0, "not on the mesh: c0"),
    ],
)
def test_weak_keypoints_are_named(box: Target, move, says: str) -> None:
    sentences = list(complaints(with_keypoints(box, move(box.keypoints_m), box.keypoint_names)))
    assert any(says in sentence for sentence in sentences), sentences


def test_points_inside_the_craft_are_seen_too_rarely(box: Target) -> None:
    points = box.keypoints_m.copy()
    points[3] = (1.0, 0.0, 0.0)
    sentences = list(complaints(with_keypoints(box, points, box.keypoint_names)))
    assert any("seen from less than" in s and s.endswith(": c3") for s in sentences), sentences


def test_keypoints_that_a_half_turn_exchanges_are_named(box: Target, rng: np.random.Generator) -> None:
    (turn,) = [t for t in near_symmetries(box, rng) if t.axis.startswith("long") and t.angle_deg == 180.0]
    np.testing.assert_allclose(turn.R @ [1.0, 0.0, 0.0], [1.0, 0.0, 0.0], atol=0.05)
    assert mistaken(box, turn) == ["c0~c3", "c1~c2", "c4~c7", "c5~c6"]
