"""What Cycles renders through us is where, as bright and as far as it should be."""

import numpy as np
import pytest
import trimesh

from proxnav.geometry import Camera, Pose, quaternion
from proxnav.records import SunSpec, Window
from proxnav.records.scene import SUN_IRRADIANCE
from proxnav.rendering.cycles import CyclesConfig
from proxnav.rendering.cycles.renderer import CyclesRenderer
from proxnav.targets import Material

pytestmark = [pytest.mark.blender, pytest.mark.usefixtures("blender")]

FACING = (0.0, 1.0, 0.0, 0.0)  # half a turn about x: the camera looks down on the target's +z side
LAMP = Material(emission=(1.0, 1.0, 1.0), ior=1.0, albedo=(0.0, 0.0, 0.0))
GREY = Material(albedo=(0.2, 0.2, 0.2), ior=1.0)
CAMERAS = {
    "pinhole": Camera(320, 256, 450.0, 450.0, 160.0, 128.0),
    "off-centre, oblong pixels": Camera(320, 256, 450.0, 410.0, 181.3, 110.6),
    "upright pixels": Camera(256, 320, 390.0, 450.0, 115.2, 168.7),
    "barrel": Camera(320, 256, 450.0, 450.0, 164.1, 121.4, (-0.22, 0.2, 1e-3, -5e-4, 0.0)),
    "pincushion": Camera(320, 256, 410.0, 450.0, 150.0, 134.0, (0.15, 0.0, -1e-3, 1e-3, 0.0)),
}


def ball(centre_m: np.ndarray, radius_m: float) -> trimesh.Trimesh:
    mesh = trimesh.creation.icosphere(subdivisions=2, radius=radius_m)
    mesh.apply_translation(centre_m)
    return mesh


def plate(width_m: float, height_m: float) -> trimesh.Trimesh:
    """Two triangles at z = 0 that face +z."""
    x, y = width_m / 2, height_m / 2
    return trimesh.Trimesh([[-x, -y, 0], [x, -y, 0], [x, y, 0], [-x, y, 0]], [[0, 1, 2], [0, 2, 3]], process=False)


@pytest.mark.parametrize("name", CAMERAS)
def test_rendered_markers_lie_where_the_camera_projects_them(name, make_target, make_scene, rng):
    camera = CAMERAS[name]
    points = np.array([[x, y, z] for x in (-3.0, 0.0, 3.0) for y in (-2.0, 2.0) for z in (-1.0, 1.0)])
    target = make_target([ball(point, 0.07) for point in points], [LAMP] * len(points))
    errors = []
    with CyclesRenderer(target, CyclesConfig(samples=32)) as renderer:
        for index in range(3):
            q = quaternion.multiply(np.array(FACING), quaternion.exp(rng.normal(0.0, 0.3, 3)))
            T = Pose.from_wxyz("cam", "target", q, [rng.uniform(-1, 1), rng.uniform(-1, 1), 14.0])
            frame = renderer.render(make_scene(camera, T, SunSpec((0.0, 0.0, 1.0), visible_fraction=0.0), index))
            errors += marker_errors(frame, camera.project(T @ points), camera)
    assert len(errors) >= 25
    assert np.max(errors) < 0.1  # px


def marker_errors(frame, expected_px, camera):
    """Distance of each isolated marker's centroid from where it should be [px]."""
    reach = 5
    for i, (x, y) in enumerate(expected_px):
        alone = np.linalg.norm(np.delete(expected_px, i, axis=0) - (x, y), axis=1).min() > 2.5 * reach
        if not (alone and reach < x < camera.width - reach and reach < y < camera.height - reach):
            continue
        rows, columns = slice(int(y) - reach, int(y) + reach + 1), slice(int(x) - reach, int(x) + reach + 1)
        light = frame.radiance[rows, columns].mean(axis=-1, dtype=np.float64)
        row, column = np.mgrid[rows, columns] + 0.5
        yield np.hypot((light * column).sum() / light.sum() - x, (light * row).sum() / light.sum() - y)


def test_a_sunlit_lambertian_plate_has_radiance_albedo_e_over_pi(make_target, make_scene):
    target = make_target([plate(4.0, 4.0)], [GREY])
    scene = make_scene(Camera(64, 64, 200.0, 200.0, 32.0, 32.0), Pose.from_wxyz("cam", "target", FACING, [0, 0, 20.0]))
    with CyclesRenderer(target, CyclesConfig(samples=16)) as renderer:
        frame = renderer.render(scene)
    expected = 0.2 * np.array(SUN_IRRADIANCE) / np.pi
    np.testing.assert_allclose(frame.radiance[20:44, 20:44].reshape(-1, 3).mean(axis=0), expected, rtol=0.01)
    assert frame.coverage[32, 32] == 1.0
    assert frame.part[32, 32] == 0


@pytest.mark.parametrize("name", CAMERAS)
def test_depth_of_a_slanted_plate_is_exact_at_pixel_centres(name, make_target, make_scene):
    camera = CAMERAS[name]
    q = quaternion.multiply(np.array(FACING), quaternion.exp(np.array([0.6, -0.5, 0.2])))
    T = Pose.from_wxyz("cam", "target", q, [0.5, -0.3, 30.0])
    with CyclesRenderer(make_target([plate(8.0, 6.0)], [GREY])) as renderer:
        frame = renderer.render(make_scene(camera, T))
    rows, columns = np.nonzero(frame.mask)
    rays = camera.unproject(np.column_stack([columns, rows]) + 0.5)
    normal, point = T.R[:, 2], T.t_m
    depth = (normal @ point) / (rays @ normal)
    assert len(rows) > 1000
    np.testing.assert_allclose(frame.depth_m[rows, columns], depth, atol=1e-3)  # m


def test_mask_holds_the_pixels_whose_centres_see_the_target(make_target, make_scene):
    camera = CAMERAS["barrel"]
    T = Pose.from_wxyz("cam", "target", FACING, [2.0, 1.0, 25.0])
    with CyclesRenderer(make_target([plate(7.0, 5.0)], [GREY])) as renderer:
        frame = renderer.render(make_scene(camera, T))
    columns, rows = np.meshgrid(np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5)
    rays = camera.unproject(np.stack([columns, rows], axis=-1))
    hits = rays * 25.0 - T.t_m
    true = (np.abs(hits[..., 0]) < 3.5) & (np.abs(hits[..., 1]) < 2.5)
    edge_px = true.sum() ** 0.5 * 4
    assert (frame.mask != true).sum() < 0.3 * edge_px
    assert (frame.mask & true).sum() / (frame.mask | true).sum() > 0.99
    assert frame.coverage.sum() == pytest.approx(true.sum(), rel=2e-3)


def test_parts_are_told_apart_and_hidden_ones_absent(make_target, make_scene):
    boxes = [trimesh.creation.box((2.0, 2.0, 1.0)), trimesh.creation.box((2.0, 2.0, 1.0)), trimesh.creation.box()]
    boxes[1].apply_translation((3.0, 0.0, 0.0))
    boxes[2].apply_translation((0.0, 0.0, -3.0))
    scene = make_scene(CAMERAS["pinhole"], Pose.from_wxyz("cam", "target", FACING, [0, 0, 20.0]))
    with CyclesRenderer(make_target(boxes, [GREY] * 3)) as renderer:
        frame = renderer.render(scene)
    assert set(np.unique(frame.part)) == {-1, 0, 1}
    assert frame.part[128, 160] == 0
    assert frame.part[128, 160 + 68] == 1


def test_a_window_shows_the_same_as_the_whole_image(make_target, make_scene):
    camera = CAMERAS["off-centre, oblong pixels"]
    target = make_target([trimesh.creation.icosphere(subdivisions=4, radius=2.0)], [GREY], smooth=True)
    scene = make_scene(camera, Pose.from_wxyz("cam", "target", FACING, [0.4, 0.2, 15.0]), SunSpec((0.0, 0.6, 0.8)))
    window = Window(150, 70, 40, 60)
    with CyclesRenderer(target, CyclesConfig(samples=64)) as renderer:
        whole, part = renderer.render(scene), renderer.render(scene, window)
    assert part.radiance.shape == (60, 40, 3)
    np.testing.assert_allclose(part.depth_m, whole.depth_m[window.slices], atol=1e-3)
    assert np.abs(part.radiance - whole.radiance[window.slices]).mean() < 0.02 * whole.radiance.max()


def test_a_target_out_of_sight_leaves_only_sky(make_target, make_scene):
    target = make_target([trimesh.creation.box()], [LAMP])
    camera = CAMERAS["pinhole"]
    with CyclesRenderer(target) as renderer:
        for t_m in ([100.0, 0.0, 10.0], [0.0, 0.0, -10.0]):
            frame = renderer.render(make_scene(camera, Pose.from_wxyz("cam", "target", FACING, t_m)))
            assert not frame.mask.any()
            assert frame.coverage.max() == 0.0
            assert np.isinf(frame.depth_m).all()


def test_the_same_scene_gives_the_same_bytes_whatever_was_rendered_before(make_target, make_scene):
    target = make_target([trimesh.creation.icosphere(subdivisions=3, radius=2.0)], [Material(roughness=0.2)])
    T = Pose.from_wxyz("cam", "target", FACING, [0.0, 0.0, 15.0])
    scene = make_scene(Camera(96, 96, 300.0, 300.0, 48.0, 48.0), T, SunSpec((0.0, 0.6, 0.8)), index=3)
    other = make_scene(CAMERAS["pinhole"], Pose.from_wxyz("cam", "target", FACING, [1.0, 0.0, 30.0]), index=4)
    with CyclesRenderer(target, CyclesConfig(samples=8)) as renderer:
        first = renderer.render(scene)
        renderer.render(other)
        again = renderer.render(scene)
    with CyclesRenderer(target, CyclesConfig(samples=8, threads=1)) as renderer:
        fresh = renderer.render(scene)
    for frame in (again, fresh):
        for name in ("radiance", "depth_m", "part", "coverage"):
            assert getattr(frame, name).tobytes() == getattr(first, name).tobytes(), name
