"""Pictures on surfaces: what the file shows where, as both renderers look it up."""

from pathlib import Path

import numpy as np
import pytest
import trimesh
from PIL import Image
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from new_craft import BLUE, BROWN, cells
from proxnav.geometry import Camera, Pose
from proxnav.records import SceneSpec, SunSpec
from proxnav.rendering.raycast import RaycastRenderer
from proxnav.targets.cad.from_mesh import from_mesh
from proxnav.targets.loading import load_target
from proxnav.targets.surface.part_image import srgb_to_linear
from proxnav.targets.surface.textures import part_textures
from proxnav.targets.target import Target
from proxnav.targets.target_files import save_target


def panel(path: Path, picture: Image.Image, uv: list[list[float]], size: tuple[float, float] = (4.0, 2.0)) -> Target:
    """A plate of two triangles in the plane z = 0, u along x and v along y, that faces -z."""
    w, h = size
    mesh = trimesh.Trimesh([[0, 0, 0], [w, 0, 0], [w, h, 0], [0, h, 0]], [[0, 2, 1], [0, 3, 2]], process=False)
    cover = PBRMaterial(baseColorTexture=picture, baseColorFactor=[1.0] * 4, metallicFactor=0.0)
    mesh.visual = TextureVisuals(uv=uv, material=cover)
    mesh.export(path)
    corners = np.array([[0.0, 0, 0], [w, 0, 0], [w, h, 0], [0, h, 0]])
    return from_mesh(path, unit_m=1.0, keypoints=(corners, tuple("abcd")))


WHOLE = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]


def colour_at(target: Target, x: float, y: float) -> np.ndarray:
    """Linear albedo at a point of the plate, from its texture coordinates as renderers interpolate them."""
    corner, uv = target.vertices_m[target.faces][..., :2], target.corner_uv_m
    for triangle, uvs in zip(corner, uv, strict=True):
        share = np.linalg.solve(np.vstack([triangle.T, np.ones(3)]), [x, y, 1.0])
        if share.min() >= -1e-9:
            texture = part_textures(target, 0.0, 0)[0]
            u, v = share @ uvs / texture.tile_m % 1.0
            h, w = texture.albedo.shape[:2]
            return texture.albedo[int(v * h), int(u * w)]
    raise AssertionError("beside the plate")


def test_cells_are_blue_and_their_rims_brown(tmp_path: Path) -> None:
    """Four by two cells of a metre: by triangle all of it would be one colour."""
    target = panel(tmp_path / "p.glb", cells(2, 4), WHOLE)
    blue, brown = (srgb_to_linear(np.array(c) / 255.0) for c in (BLUE, BROWN))
    for i in range(4):
        for j in range(2):
            np.testing.assert_allclose(colour_at(target, i + 0.5, j + 0.5), blue, atol=0.01)
            np.testing.assert_allclose(colour_at(target, i + 0.03, j + 0.5), brown, atol=0.02)
    expected = blue + (brown - blue) * (1 - (26 / 32) ** 2)
    np.testing.assert_allclose(target.materials[0].albedo, expected, rtol=0.05)


def test_rows_of_a_picture_run_from_the_top(tmp_path: Path) -> None:
    """v points up in the file: the picture's first row lies at v = 1."""
    rows = np.repeat(np.array([250, 10], np.uint8), 32)
    picture = Image.fromarray(np.repeat(rows[:, None, None], 3, axis=2).repeat(64, axis=1))
    target = panel(tmp_path / "p.glb", picture, WHOLE)
    assert colour_at(target, 2.0, 1.7)[0] > 0.9
    assert colour_at(target, 2.0, 0.3)[0] < 0.05


@pytest.mark.parametrize(
    "uv", [[[0.5, 0.5], [1.0, 0.5], [1.0, 1.0], [0.5, 1.0]], [[2.5, 0.5], [3.0, 0.5], [3.0, 1.0], [2.5, 1.0]]]
)
def test_a_piece_of_a_picture_is_cut_out_or_repeats(tmp_path: Path, uv: list[list[float]]) -> None:
    """A red quarter at the top right of an atlas."""
    atlas = np.zeros((64, 64, 3), np.uint8)
    atlas[:32, 32:] = [255, 0, 0]
    target = panel(tmp_path / "p.glb", Image.fromarray(atlas), uv)
    for x in (0.4, 2.0, 3.6):
        np.testing.assert_allclose(colour_at(target, x, 1.0), [1.0, 0.0, 0.0], atol=0.03)


def test_a_metre_of_texture_is_a_metre_both_ways(tmp_path: Path) -> None:
    """8 m x 1 m under one square picture: texels stay square on the surface, so that lookups average rightly."""
    target = panel(tmp_path / "p.glb", cells(8, 8), WHOLE, (8.0, 1.0))
    uv = target.corner_uv_m.reshape(-1, 2)
    np.testing.assert_allclose(np.ptp(uv, axis=0), [8.0, 1.0], rtol=1e-6)


def test_a_saved_picture_is_loaded_texel_by_texel(tmp_path: Path) -> None:
    target = panel(tmp_path / "p.glb", cells(2, 4), WHOLE)
    save_target(target, tmp_path / "panel")
    loaded = load_target(str(tmp_path / "panel"))
    (name,) = target.images
    np.testing.assert_array_equal(loaded.images[name].srgb, target.images[name].srgb)
    assert loaded.images[name].tile_m == target.images[name].tile_m


def test_looks_vary_about_the_picture(tmp_path: Path) -> None:
    target = panel(tmp_path / "p.glb", cells(2, 4), WHOLE)
    plain = part_textures(target, 0.0, 0)[0].albedo
    mild = part_textures(target, 0.3, 5)[0].albedo
    assert mild.shape == plain.shape
    assert not np.array_equal(mild, plain)
    assert np.corrcoef(mild[..., 2].ravel(), plain[..., 2].ravel())[0, 1] > 0.99


def test_the_ray_caster_shows_cells_and_rims(tmp_path: Path) -> None:
    target = panel(tmp_path / "p.glb", cells(2, 4), WHOLE)
    camera = Camera(256, 128, 256.0, 256.0, 128.0, 64.0)
    T = Pose.from_wxyz("cam", "target", [1, 0, 0, 0], [-2.0, -1.0, 4.2])  # the plate fills the frame: 61 px a metre
    spec = SceneSpec(0, "panel", camera, tuple(T.q_wxyz.tolist()), tuple(T.t_m.tolist()), SunSpec((0.0, 0.0, -1.0)))
    radiance = RaycastRenderer(target).render(spec).radiance
    for i in range(4):
        (x, y), (rim, _) = camera.project(T @ np.array([[i + 0.5, 0.5, 0.0], [i + 0.04, 0.5, 0.0]]))
        cell, edge = radiance[int(y), int(x)], radiance[int(y), int(rim)]
        assert cell[2] > 3 * cell[0]  # blue
        assert edge[0] > 2 * edge[2]  # brown
