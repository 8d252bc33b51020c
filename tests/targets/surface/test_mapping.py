"""Normals and texture coordinates of any mesh."""

import numpy as np
import trimesh

from proxnav.targets.solids import ball, box
from proxnav.targets.surface.mapping import corner_normals, corner_uv_m, face_normals


def test_sphere_normals_point_along_the_radius():
    sphere = ball("s", (1.0, 2.0, 3.0), 2.0, n=40)
    normal = corner_normals(sphere.vertices_m, sphere.faces)
    radial = (sphere.vertices_m[sphere.faces] - [1.0, 2.0, 3.0]) / 2.0
    cosine = np.einsum("ijk,ijk->ij", normal, radial)
    assert cosine.min() > np.cos(np.radians(1.5))


def test_box_keeps_its_edges_sharp():
    cube = box("c", (0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    normal = corner_normals(cube.vertices_m, cube.faces)
    expected = np.repeat(face_normals(cube.vertices_m, cube.faces)[:, None], 3, axis=1)
    np.testing.assert_allclose(normal, expected, atol=1e-12)


def test_normals_do_not_depend_on_shared_or_split_vertices():
    sphere = ball("s", (0.0, 0.0, 0.0), 1.0)
    split = sphere.vertices_m[sphere.faces].reshape(-1, 3)
    joined = corner_normals(sphere.vertices_m, sphere.faces)
    apart = corner_normals(split, np.arange(len(split)).reshape(-1, 3))
    np.testing.assert_allclose(joined, apart, atol=1e-12)


def test_smooth_normals_agree_with_trimesh_on_a_smooth_mesh():
    mesh = trimesh.creation.icosphere(subdivisions=2)
    ours = corner_normals(np.asarray(mesh.vertices), np.asarray(mesh.faces), smooth_angle=3.2)
    theirs = mesh.vertex_normals[mesh.faces]
    assert np.einsum("ijk,ijk->ij", ours, theirs).min() > np.cos(np.radians(0.5))


def test_uv_are_metres_on_faces_along_the_axes():
    cube = box("c", (0.0, 0.0, 0.0), (1.0, 2.0, 3.0))
    uv = corner_uv_m(cube.vertices_m, cube.faces)
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    uv_area = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2
    np.testing.assert_allclose(uv_area, trimesh.Trimesh(cube.vertices_m, cube.faces).area_faces, atol=1e-12)  # m^2


def test_texture_is_never_mirrored():
    sphere = ball("s", (0.0, 0.0, 0.0), 1.0)
    uv = corner_uv_m(sphere.vertices_m, sphere.faces)
    a, b = uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]
    assert (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0] > 0).all()


def test_empty_mesh_has_no_normals():
    assert corner_normals(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)).shape == (0, 3, 3)


def test_triangle_without_area_gets_a_finite_normal():
    vertices = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    assert np.isfinite(corner_normals(vertices, np.array([[0, 1, 2]]))).all()
