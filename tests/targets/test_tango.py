"""Tango: its published points, its solids, and whether its sides can be told apart."""

import numpy as np
import pytest
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.targets.keypoints.visibility import visible_keypoints
from proxnav.targets.loading import load_target
from proxnav.targets.tango import TangoParams, tango
from proxnav.targets.tango.antennas import antennas
from proxnav.targets.tango.brackets import brackets
from proxnav.targets.tango.equipment import equipment
from proxnav.targets.tango.structure import structure

PUBLISHED_M = np.array(
    [
        (-0.37, -0.385, 0.3215), (-0.37, 0.385, 0.3215), (0.37, 0.385, 0.3215), (0.37, -0.385, 0.3215),
        (-0.37, -0.264, 0.0), (-0.37, 0.304, 0.0), (0.37, 0.304, 0.0), (0.37, -0.264, 0.0),
        (-0.5427, 0.4877, 0.2535), (0.5427, 0.4877, 0.2591), (0.305, -0.579, 0.2515),
    ]
)  # fmt: skip
"""The eleven points that SPEED+'s authors publish, in their order."""


def test_first_keypoints_are_the_published_ones_in_their_order():
    np.testing.assert_allclose(tango().keypoints_m[:11], PUBLISHED_M, atol=1e-9)
    np.testing.assert_array_equal(load_target("tango").with_subset("published").keypoints_m, tango().keypoints_m[:11])


def test_keypoints_lie_on_the_mesh_and_are_named_once():
    target = tango()
    assert len(set(target.keypoint_names)) == 24
    corners = target.vertices_m[target.faces]
    gap = [
        np.linalg.norm(trimesh.triangles.closest_point(corners, np.tile(k, (len(corners), 1))) - k, axis=1).min()
        for k in target.keypoints_m
    ]
    assert max(gap) < 0.001  # m


@settings(max_examples=4, deadline=None)
@given(
    st.builds(
        TangoParams,
        panel_thickness_m=st.floats(0.01, 0.04),
        wall_inset_m=st.floats(0.005, 0.04),
        cell_rows=st.integers(1, 17),
        cell_columns=st.integers(1, 4),
    )
)
def test_every_solid_is_closed_and_faces_outward(params: TangoParams):
    for piece in [*structure(params), *antennas(params), *brackets(params), *equipment(params)]:
        mesh = trimesh.Trimesh(piece.vertices_m, piece.faces)
        assert mesh.is_watertight, piece.part
        assert mesh.is_winding_consistent, piece.part
        assert mesh.volume > 0, piece.part


def test_panel_carries_a_grid_of_cells_about_a_strip():
    target = tango()
    cells = target.vertices_m[np.unique(target.faces[target.face_part == target.part_names.index("cells")])]
    assert len(cells) == 2 * 4 * 17 * 12
    assert np.abs(cells[:, 0] - TangoParams().strip_x_m).min() > 0.015  # m
    assert np.abs(cells[:, 1]).max() < 0.385


def test_no_turn_of_the_box_leaves_the_craft_unchanged():
    target = tango()
    for signs in ((-1.0, -1.0, 1.0), (-1.0, 1.0, 1.0), (1.0, -1.0, 1.0)):
        turned = target.vertices_m * signs
        nearest = np.linalg.norm(turned[:, None, :] - PUBLISHED_M[8:], axis=2).min(axis=0)
        assert nearest.max() > 0.02  # m: an antenna's tip has no counterpart


def test_a_view_from_above_shows_the_panel_and_hides_the_bottom():
    target = tango()
    above = Pose.from_wxyz("cam", "target", (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 5.0))
    seen = visible_keypoints(target, above)
    assert seen[:4].all()
    assert not seen[4:8].any()


def test_lengths_that_do_not_fit_are_refused_by_name():
    with pytest.raises(InputError, match="cell_rows"):
        TangoParams(cell_rows=30)
    with pytest.raises(InputError, match="cell_columns"):
        TangoParams(cell_columns=5)
    with pytest.raises(InputError, match="wall_inset_m"):
        TangoParams(wall_inset_m=-0.01)


def test_antennas_tips_are_seen_from_the_side_that_they_point_to():
    from_high_y = Pose.from_wxyz("cam", "target", (0.0, 0.0, 0.5**0.5, -(0.5**0.5)), (0.0, 0.25, 5.0))
    assert visible_keypoints(tango(), from_high_y)[8:11].tolist() == [True, True, False]
