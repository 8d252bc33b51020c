"""Where things are in the picture: depth, mask, markers, windows and crops."""

import numpy as np
import pytest
import trimesh
from raycast_shapes import MATT, plate, scene, target

from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.compiled.lens import lens_numbers
from proxnav.records import Window
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.rendering.raycast.rays import cast
from proxnav.targets import Material

CAMERA = Camera(200, 160, 300.0, 310.0, 97.0, 83.0)
BENT = Camera(200, 160, 300.0, 310.0, 97.0, 83.0, (-0.22, 0.31, -0.0007, 0.0004, -0.1))
RATIONAL = Camera(200, 160, 300.0, 310.0, 97.0, 83.0, (0.31, 0.02, 4e-4, -6e-4, 0.001, 0.66, 0.08, 0.003))
FISHEYE = Camera(200, 160, 310.0, 312.0, 97.0, 83.0, (-0.02, 0.006, -0.004, 0.0008), "fisheye")
CAMERAS = pytest.mark.parametrize(
    "camera", [CAMERA, BENT, RATIONAL, FISHEYE], ids=["straight", "distorted", "rational", "fisheye"]
)
LAMP = Material(albedo=(0.0, 0.0, 0.0), ior=1.0, emission=(3.0, 2.0, 1.0))


@pytest.fixture(scope="module")
def craft() -> RaycastRenderer:
    """A body, a wing and a box: silhouettes, creases and cast shadows."""
    body = trimesh.creation.icosphere(subdivisions=3, radius=1.0)
    wing = trimesh.creation.box((5.0, 0.06, 1.0))
    box = trimesh.creation.box((1.2, 1.2, 1.2), trimesh.transformations.translation_matrix([0.0, 0.0, 1.5]))
    metal = Material(metallic=1.0, roughness=0.3, albedo=(0.9, 0.7, 0.4))
    return RaycastRenderer(target([body, wing, box], [MATT, Material(roughness=0.2), metal]))


def oblique(distance: float = 14.0) -> Pose:
    q = quaternion.normalize(np.array([0.5, -0.5, 0.3, 0.2]))
    return Pose.from_wxyz("cam", "target", q, [0.2, 0.1, distance])


@CAMERAS
def test_rays_are_those_of_the_camera(camera: Camera, rng: np.random.Generator) -> None:
    places = rng.uniform((-3, -3), (203, 163), (500, 2))
    rays, origins, directions = np.empty((500, 3)), np.empty((500, 3), np.float32), np.empty((500, 3), np.float32)
    cast(places, lens_numbers(camera), np.eye(3), np.zeros(3), np.zeros(3), 1.0, rays, origins, directions)
    np.testing.assert_allclose(rays, camera.unproject(places), atol=1e-9)


@CAMERAS
def test_depth_of_a_tilted_plane_is_its_closed_form(camera: Camera) -> None:
    pose = Pose.from_wxyz("cam", "target", quaternion.exp(np.array([0.4, -0.3, 0.1])), [0.1, -0.2, 100.0])
    frame = RaycastRenderer(target([plate(60.0)], [MATT])).render(scene(camera, pose=pose))
    normal = pose.R @ np.array([0.0, 0.0, 1.0])
    rays = camera.unproject(np.stack(np.meshgrid(np.arange(200) + 0.5, np.arange(160) + 0.5), axis=-1))
    np.testing.assert_allclose(frame.depth_m, (pose.t_m @ normal) / (rays @ normal), atol=1e-4)


def test_mask_and_coverage_of_a_sphere_are_its_silhouette() -> None:
    ball = trimesh.creation.icosphere(subdivisions=6, radius=1.0)
    frame = RaycastRenderer(target([ball], [MATT], smooth=True)).render(scene(CAMERA, 10.0))
    rays = CAMERA.unproject(np.stack(np.meshgrid(np.arange(200) + 0.5, np.arange(160) + 0.5), axis=-1))
    cosine = rays[..., 2] / np.linalg.norm(rays, axis=-1)
    inside = cosine > np.sqrt(1.0 - 0.1**2)
    assert (frame.mask != inside).sum() <= 2
    solid_angle = (frame.coverage * cosine**3).sum() / (CAMERA.fx * CAMERA.fy)
    assert solid_angle == pytest.approx(2.0 * np.pi * (1.0 - np.sqrt(1.0 - 0.1**2)), rel=2e-3)


@CAMERAS
def test_lamps_appear_where_the_camera_projects_them(camera: Camera, rng: np.random.Generator) -> None:
    centres = np.array([[x, y, rng.uniform(-1.0, 1.0)] for x in (-2.2, 0.3, 2.4) for y in (-1.8, 0.1, 1.9)])
    lamps = [trimesh.creation.icosphere(subdivisions=3, radius=0.06).apply_translation(c) for c in centres]
    renderer = RaycastRenderer(target(lamps, [LAMP] * len(lamps)))
    image = renderer.render(scene(camera, 9.0)).radiance[..., 0]
    y, x = np.mgrid[0:160, 0:200] + 0.5
    for expected in camera.project(centres + np.array([0.0, 0.0, 9.0])):
        near = image * (np.hypot(x - expected[0], y - expected[1]) < 6.0)
        found = np.array([(near * x).sum(), (near * y).sum()]) / near.sum()
        np.testing.assert_allclose(found, expected, atol=0.1)  # px


def test_a_window_is_the_same_region_of_the_full_frame(craft: RaycastRenderer) -> None:
    spec = scene(BENT, sun=(0.5, -0.6, -0.4), pose=oblique(8.0))
    full, window = craft.render(spec), Window(61, 33, 70, 58)
    part = craft.render(spec, window)
    rows, columns = window.slices
    for name in ("radiance", "depth_m", "part", "coverage"):
        np.testing.assert_array_equal(getattr(part, name), getattr(full, name)[rows, columns])


def test_a_window_beside_the_target_is_empty(craft: RaycastRenderer) -> None:
    frame = craft.render(scene(CAMERA, pose=oblique(200.0)), Window(0, 0, 20, 20))
    assert not frame.mask.any()
    assert not frame.radiance.any()
    assert np.isinf(frame.depth_m).all()


def test_a_crop_camera_sees_the_full_frame_resampled(craft: RaycastRenderer) -> None:
    spec = scene(BENT, sun=(0.5, -0.6, -0.4), pose=oblique())
    full = craft.render(spec)
    crop = craft.render(spec, camera=BENT.cropped(40.0, 20.0, 120, 120).resized(240, 240))
    assert crop.radiance.shape == (240, 240, 3)
    halved = crop.radiance.reshape(120, 2, 120, 2, 3).mean(axis=(1, 3))
    difference = np.abs(halved - full.radiance[20:140, 40:160])
    assert np.median(difference[full.mask[20:140, 40:160]]) < 0.01 * full.radiance.max()
    assert difference.mean() < 0.01 * full.radiance.max()


def test_more_interior_samples_change_little(craft: RaycastRenderer) -> None:
    spec = scene(CAMERA, sun=(0.5, -0.6, -0.4), pose=oblique())
    fine = RaycastRenderer(craft.target, RaycastConfig(samples=16, interior_samples=16, sun_samples=16))
    a, b = craft.render(spec).radiance, fine.render(spec).radiance
    assert np.sqrt(((a - b) ** 2).mean()) < 0.03 * b.max()
