"""The generated stack: its size, its surface, and whether its sides can be told apart."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from proxnav.errors import InputError
from proxnav.targets.keypoints.visibility import first_faces, first_hits
from proxnav.targets.solids import Piece
from proxnav.targets.space_rider import SpaceRiderParams, space_rider
from proxnav.targets.space_rider.equipment import equipment
from proxnav.targets.space_rider.orbital_module import orbital_module
from proxnav.targets.space_rider.reentry_module import reentry_module
from proxnav.targets.space_rider.wings import wings


def mesh_of(pieces: list[Piece]) -> trimesh.Trimesh:
    offset = np.cumsum([0, *(len(p.vertices_m) for p in pieces)])
    faces = np.concatenate([p.faces + start for p, start in zip(pieces, offset[:-1], strict=True)])
    mesh = trimesh.Trimesh(np.concatenate([p.vertices_m for p in pieces]), faces, process=False)
    mesh.merge_vertices(digits_vertex=8)
    return mesh


def test_extents_are_the_published_ones():
    target = space_rider()
    low, high = target.vertices_m.min(axis=0), target.vertices_m.max(axis=0)
    assert high[0] == pytest.approx(4.02, abs=1e-9)  # m
    assert low[0] == pytest.approx(-4.02, abs=1e-9)
    assert high[1] - low[1] == pytest.approx(11.2, abs=1e-9)
    body = mesh_of([p for p in reentry_module(SpaceRiderParams()) if p.part in ("nose_cap", "belly", "leeside")])
    np.testing.assert_allclose(body.extents, [4.6, 2.2, 1.4], atol=0.02)


def test_nose_cap_has_its_published_diameter():
    target = space_rider()
    cap = target.faces[target.face_part == target.part_names.index("nose_cap")]
    assert np.ptp(target.vertices_m[cap.ravel(), 1]) == pytest.approx(1.30, abs=0.01)


def test_triangle_count_suits_a_ray_caster():
    assert 5_000 <= len(space_rider().faces) <= 30_000


@settings(max_examples=4, deadline=None)
@given(
    st.builds(
        SpaceRiderParams,
        body_length_m=st.floats(4.3, 4.8),
        body_width_m=st.floats(1.9, 2.4),
        body_height_m=st.floats(1.2, 1.6),
        wing_span_m=st.floats(6.0, 14.0),
        panels_per_wing=st.integers(1, 5),
    )
)
def test_every_solid_is_closed_and_faces_outward(params: SpaceRiderParams):
    skin = [p for p in reentry_module(params) if p.part not in ("flap_left", "flap_right", "thrusters")]
    panels = [p for p in wings(params) if p.part in ("wing_cells", "wing_backs", "wing_frames")]
    whole = (p for p in reentry_module(params) if p.part in ("flap_left", "flap_right", "thrusters"))
    single = [*whole, *orbital_module(params), *equipment(params)]
    for mesh in (mesh_of(skin), mesh_of(panels), *(mesh_of([p]) for p in single)):
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert mesh.volume > 0


def test_rays_from_all_sides_meet_front_faces(rng: np.random.Generator):
    target = space_rider()
    mesh = trimesh.Trimesh(target.vertices_m, target.faces, process=False)
    outward = rng.normal(size=(2000, 3))
    outward /= np.linalg.norm(outward, axis=1, keepdims=True)
    aim = target.vertices_m[rng.integers(len(target.vertices_m), size=2000)] * 0.98
    _, face = first_faces(target, aim + 30 * outward, -outward)
    hit = face >= 0
    assert hit.mean() > 0.9
    facing = np.einsum("ij,ij->i", mesh.face_normals[face[hit]], outward[hit])
    assert (facing > 0).all()


def test_keypoints_lie_on_the_mesh_and_are_named_once():
    target = space_rider()
    assert len(set(target.keypoint_names)) == 24
    corners = target.vertices_m[target.faces]
    gap = [
        np.linalg.norm(trimesh.triangles.closest_point(corners, np.tile(k, (len(corners), 1))) - k, axis=1).min()
        for k in target.keypoints_m
    ]
    assert max(gap) < 0.01  # m


def test_six_are_spread_and_not_coplanar():
    six = space_rider().with_subset("six")
    assert len(six.keypoint_names) == 6
    assert sum(name.startswith("wing") for name in six.keypoint_names) >= 2
    spread = np.linalg.svd(six.keypoints_m - six.keypoints_m.mean(axis=0), compute_uv=False)
    assert spread[2] > 1.0  # m: root sum of squares out of the best plane


def test_half_turn_about_the_long_axis_changes_shape_and_tone():
    target = space_rider()
    dark, light = (target.materials[target.part_names.index(part)].albedo for part in ("belly", "leeside"))
    assert max(dark) < 0.2 < 0.4 < min(light)
    y = np.linspace(-5.0, 5.0, 41)
    x = np.linspace(-3.9, 3.9, 41)
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    top = first_hits(target, np.column_stack([grid, np.full(len(grid), -20.0)]), np.tile([0.0, 0, 1], (len(grid), 1)))
    turned = grid * [1.0, -1.0]
    under = first_hits(
        target, np.column_stack([turned, np.full(len(grid), 20.0)]), np.tile([0.0, 0, -1], (len(grid), 1))
    )
    both = np.isfinite(top) & np.isfinite(under)
    assert np.median(np.abs(top[both] - under[both])) > 0.1  # m


def test_left_and_right_differ():
    target = space_rider()
    corners = target.vertices_m[target.faces]
    by_part = {name: corners[target.face_part == i][..., 1].mean() for i, name in enumerate(target.part_names)}
    assert by_part["dish"] < -0.5 < 0.5 < by_part["radiator"]
    assert by_part["marking_left"] < -0.5


def test_parameters_that_do_not_fit_are_refused_by_name():
    with pytest.raises(InputError, match="engine bell"):
        SpaceRiderParams(module_length_m=4.0)
    with pytest.raises(InputError, match="wing_chord_m"):
        SpaceRiderParams(wing_chord_m=-1.0)
    with pytest.raises(InputError, match="wing_span_m"):
        SpaceRiderParams(wing_span_m=3.0)
