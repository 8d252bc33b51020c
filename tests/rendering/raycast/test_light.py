"""How bright things are: photometry, shadows, reflection between surfaces, reproducibility."""

import hashlib
import json
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from raycast_shapes import MATT, plate, scene, target

from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.records import SunSpec
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.targets import Material

CAMERA = Camera(128, 128, 400.0, 400.0, 64.0, 64.0)
SUN = np.array(SunSpec((0.0, 0.0, 1.0)).irradiance)


def test_a_painted_plate_of_albedo_0_2_reflects_albedo_e_over_pi_on_average() -> None:
    frame = RaycastRenderer(target([plate(0.9)], [MATT])).render(scene(CAMERA))  # 3 x 3 tiles of paint
    inside = frame.coverage == 1.0
    np.testing.assert_allclose(frame.radiance[inside].mean(axis=0), 0.2 * SUN / np.pi, rtol=0.01)


@pytest.mark.usefixtures("even_surfaces")
@pytest.mark.parametrize("angle", [0.0, 0.5, 1.2])
def test_a_lambertian_plate_reflects_albedo_e_cosine_over_pi(angle: float) -> None:
    frame = RaycastRenderer(target([plate()], [MATT])).render(scene(CAMERA, sun=(np.sin(angle), 0.0, -np.cos(angle))))
    expected = 0.2 * SUN * np.cos(angle) / np.pi
    np.testing.assert_allclose(frame.radiance[64, 64], expected, rtol=1e-5)


@pytest.mark.usefixtures("even_surfaces")
def test_eclipse_dims_the_sun_by_its_visible_fraction() -> None:
    spec = scene(CAMERA)
    partly = replace(spec, sun=SunSpec((0.0, 0.0, -1.0), visible_fraction=0.25))
    frame = RaycastRenderer(target([plate()], [MATT])).render(partly)
    np.testing.assert_allclose(frame.radiance[64, 64], 0.25 * 0.2 * SUN / np.pi, rtol=1e-5)


@pytest.mark.usefixtures("even_surfaces")
def test_a_mirror_of_rough_metal_shows_the_peak_of_its_lobe() -> None:
    metal = Material(albedo=(0.9, 0.8, 0.7), metallic=1.0, roughness=0.5)
    frame = RaycastRenderer(target([plate()], [metal])).render(scene(CAMERA))
    alpha = 0.25
    peak = 1.0 / (np.pi * alpha**2) / 4.0  # D(0) G2 / (4 n.l n.v) with everything along the normal
    np.testing.assert_allclose(frame.radiance[64, 64], np.array([0.9, 0.8, 0.7]) * SUN * peak, rtol=1e-3)


@pytest.mark.usefixtures("even_surfaces")
def test_the_shadow_of_a_plate_falls_where_geometry_says() -> None:
    wall, blocker = plate(3.0, z=0.0), plate(0.5, z=-2.0)
    blocker.apply_translation([1.0, 0.0, 0.0])
    spec = scene(CAMERA, 10.0, sun=(1.0, 0.0, -1.0))  # 45 deg: the shadow is thrown 2 m towards -x
    camera = Camera(256, 256, 400.0, 400.0, 128.0, 128.0)
    image = RaycastRenderer(target([wall, blocker], [MATT, MATT])).render(spec, camera=camera).radiance[..., 0]
    lit = 0.2 * SUN[0] * np.cos(np.pi / 4) / np.pi
    row = image[128] / lit
    x = (np.arange(256) + 0.5 - 128.0) / 40.0  # m on the wall, 10 m away
    np.testing.assert_allclose(row[np.abs(x + 1.0) < 0.4], 0.0, atol=0.05)
    assert row[(x < -1.6) & (x > -2.9)] == pytest.approx(1.0, abs=0.02)
    dark_m = (1.0 - row[(x > -2.0) & (x < 0.0)]).sum() / 40.0
    assert dark_m == pytest.approx(1.0, abs=0.02)  # half the light at the geometric edges


@pytest.mark.usefixtures("even_surfaces")
@pytest.mark.parametrize("half_angle", [SUN_HALF_ANGLE, 0.15])
def test_a_penumbra_is_as_wide_as_the_sun_or_the_lamp(half_angle: float) -> None:
    wall, blocker = plate(3.0, z=0.0), plate(1.0, z=-2.0)
    blocker.apply_translation([-1.0, 0.0, 0.0])
    pixel_m = 1e-3 * half_angle / SUN_HALF_ANGLE
    camera = Camera(100, 40, 10.0 / pixel_m, 10.0 / pixel_m, 50.0, 20.0)  # looks at x = 0.5 on the wall
    pose = Pose.from_wxyz("cam", "target", quaternion.IDENTITY, [-0.5, 0.0, 10.0])
    spec = scene(camera, pose=pose, sun=(-0.25, 0.0, -1.0))  # the edge at x = 0 is thrown to x = 0.5
    spec = replace(spec, sun=replace(spec.sun, half_angle_rad=half_angle))
    config = RaycastConfig(sun_samples=256)
    row = RaycastRenderer(target([wall, blocker], [MATT, MATT]), config).render(spec).radiance[20, :, 0]
    x = (np.arange(100) + 0.5 - 50.0) * pixel_m
    distance = np.hypot(2.0, 0.5)
    half = half_angle * distance * np.hypot(1.0, 0.25)  # slant distance times half angle, on the inclined wall
    share = row / row[-1]
    assert share[np.abs(x) < pixel_m].mean() == pytest.approx(0.5, abs=0.05)
    # a disc cut by a straight edge: 0.8045 of it is free when the edge lies half a radius from its centre
    assert np.interp(0.5 * half, x, share) == pytest.approx(0.8045, abs=0.06)


def test_surfaces_light_each_other() -> None:
    floor, wall = plate(2.0), plate(2.0)
    wall.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, [0, 1, 0]))
    wall.apply_translation([2.0, 0.0, -2.0])
    if wall.face_normals[0, 0] > 0.0:
        wall.invert()
    shape = target([floor, wall], [Material(albedo=(0.8,) * 3, ior=1.0, roughness=1.0), MATT])
    spec = scene(CAMERA, pose=Pose.from_wxyz("cam", "target", quaternion.exp(np.array([0, 0.9, 0])), [0, 0, 12.0]))
    spec = replace(spec, sun=SunSpec((0.05, 0.0, -0.9987)))  # lights the floor, passes behind the wall
    alone = RaycastRenderer(shape, RaycastConfig(bounces=0)).render(spec)
    both = RaycastRenderer(shape, RaycastConfig(bounces=1)).render(spec)
    on_wall = both.part == 1
    assert on_wall.sum() > 50
    gain = (both.radiance - alone.radiance)[on_wall, 0]
    # floor exitance 0.8 E; the wall sees less than half of its sky filled by the floor
    ceiling = 0.2 / np.pi * 0.5 * 0.8 * SUN[0]
    assert 0.1 * ceiling < np.median(gain) < ceiling


@pytest.mark.usefixtures("even_surfaces")
def test_shading_normals_smooth_a_facetted_sphere() -> None:
    ball = trimesh.creation.icosphere(subdivisions=2, radius=1.0)
    image = RaycastRenderer(target([ball], [MATT], smooth=True)).render(scene(CAMERA)).radiance[..., 0]
    rays = CAMERA.unproject(np.stack(np.meshgrid(np.arange(128) + 0.5, np.arange(128) + 0.5), axis=-1))
    a, b = (rays**2).sum(axis=-1), 10.0 * rays[..., 2]
    root = b**2 - a * 99.0  # |s ray - (0, 0, 10)| = 1
    inside = root > 0.3
    cosine = 10.0 - (b - np.sqrt(np.maximum(root, 0.0))) / a * rays[..., 2]
    np.testing.assert_allclose(image[inside], 0.2 * SUN[0] / np.pi * cosine[inside], rtol=0.04)


def test_frames_are_identical_in_another_process_and_order() -> None:
    script = Path(__file__).with_name("hash_frames.py")
    results = [
        json.loads(subprocess.run([sys.executable, str(script), *order], capture_output=True, check=True).stdout)
        for order in (("0", "1", "2"), ("2", "0"))
    ]
    assert results[0]["2"] == results[1]["2"]
    assert results[0]["0"] == results[1]["0"]
    assert len(set(results[0].values())) == 3
    assert all(len(value) == len(hashlib.sha256().hexdigest()) for value in results[0].values())
