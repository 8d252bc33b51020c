"""Cycles evaluates the reflectance of targets/material.py, the textures and the light from all around as agreed."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from proxnav.geometry import Camera, Pose
from proxnav.records import EarthSpec, SunSpec
from proxnav.rendering.cycles import CyclesConfig, materials, renderer
from proxnav.rendering.cycles.renderer import CyclesRenderer
from proxnav.targets import Material
from proxnav.targets.surface.textures import PartTexture

pytestmark = [pytest.mark.blender, pytest.mark.usefixtures("blender")]

CAMERA = Camera(32, 32, 100.0, 100.0, 16.0, 16.0)
T_FACING = Pose.from_wxyz("cam", "target", [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 20.0])  # from +z, image right is +x
PLATE = trimesh.Trimesh([[-2, -2, 0], [2, -2, 0], [2, 2, 0], [-2, 2, 0]], [[0, 1, 2], [0, 2, 3]], process=False)
WHITE_SUN = (1.0, 1.0, 1.0)


def looking_from(direction: np.ndarray) -> Pose:
    """A camera 20 m from the target's origin that looks at it."""
    z = -direction / np.linalg.norm(direction)
    x = np.cross(z, (0.3, 0.9, 0.2))
    x /= np.linalg.norm(x)
    return Pose.from_matrix("cam", "target", np.array([x, np.cross(z, x), z]), [0.0, 0.0, 20.0])


def reflectance(material: Material, n: np.ndarray, v: np.ndarray, s: np.ndarray) -> np.ndarray:
    """f(v, s) [1/sr] of targets/material.py, term by term."""
    alpha, h = material.roughness**2, (v + s) / np.linalg.norm(v + s)
    nv, ns, nh = n @ v, n @ s, n @ h
    D = alpha**2 / (np.pi * (nh**2 * (alpha**2 - 1.0) + 1.0) ** 2)

    def shadowing(c: float) -> float:
        return (np.sqrt(1.0 + alpha**2 * (1.0 / c**2 - 1.0)) - 1.0) / 2.0

    g = D / (1.0 + shadowing(nv) + shadowing(ns)) / (4.0 * nv * ns)
    refracted = np.sqrt(1.0 - (1.0 - nv**2) / material.ior**2)
    r_s = (nv - material.ior * refracted) / (nv + material.ior * refracted)
    r_p = (material.ior * nv - refracted) / (material.ior * nv + refracted)
    F = 0.5 * (r_s**2 + r_p**2)
    albedo, m = np.array(material.albedo), material.metallic
    return (1.0 - m) * ((1.0 - F) * albedo / np.pi + F * g) + m * albedo * g


@pytest.mark.parametrize(
    "material",
    [
        Material(albedo=(0.8, 0.4, 0.2), roughness=0.5),
        Material(albedo=(0.02, 0.03, 0.08), roughness=0.3, ior=1.45),
        Material(albedo=(0.9, 0.6, 0.3), metallic=1.0, roughness=0.4),
        Material(albedo=(0.5, 0.5, 0.6), metallic=0.4, roughness=0.6, ior=1.7),
    ],
    ids=["paint", "cover glass", "foil", "mixed"],
)
def test_a_sunlit_plate_reflects_as_the_material_says(material, make_target, make_scene):
    n = np.array([0.0, 0.0, 1.0])
    views = [np.array(v) / np.linalg.norm(v) for v in ([0.1, 0.2, 1.0], [1.0, -0.3, 0.7], [0.2, 1.0, 0.4])]
    suns = [np.array(s) / np.linalg.norm(s) for s in ([-0.2, 0.1, 1.0], [-1.0, 0.3, 0.9], [0.6, -0.5, 0.5])]
    with CyclesRenderer(make_target([PLATE], [material]), CyclesConfig(samples=16)) as cycles:
        for v, s in zip(views, suns, strict=True):
            frame = cycles.render(make_scene(CAMERA, looking_from(v), SunSpec(tuple(s.tolist()), 1.0, WHITE_SUN)))
            found = frame.radiance[15:17, 15:17].mean(axis=(0, 1))
            np.testing.assert_allclose(found, reflectance(material, n, v, s) * (n @ s), rtol=0.02)


def test_half_a_sun_gives_half_the_light_and_none_gives_none(make_target, make_scene):
    with CyclesRenderer(make_target([PLATE], [Material(ior=1.0)]), CyclesConfig(samples=4)) as cycles:
        levels = [
            cycles.render(make_scene(CAMERA, T_FACING, SunSpec((0.0, 0.0, 1.0), share, WHITE_SUN))).radiance[8:24, 8:24]
            for share in (0.0, 0.5, 1.0, 0.0)
        ]
    np.testing.assert_allclose([level.mean() for level in levels], np.array([0, 0.5, 1, 0]) * 0.5 / np.pi, rtol=0.01)
    np.testing.assert_allclose(levels[2], 2.0 * levels[1], rtol=1e-4)


def test_light_from_all_around_comes_from_where_the_map_says(make_target, make_scene, monkeypatch):
    # L = 1 + u.d has the irradiance pi + 2/3 pi u.n on a plate with normal n
    u = np.array([0.5, -0.3, 0.7])
    polar, azimuth = np.pi * (np.arange(64) + 0.5) / 64, -np.pi + 2 * np.pi * (np.arange(128) + 0.5) / 128
    d = np.stack(
        np.broadcast_arrays(
            np.sin(polar)[:, None] * np.cos(azimuth), np.sin(polar)[:, None] * np.sin(azimuth), np.cos(polar)[:, None]
        ),
        axis=-1,
    )
    monkeypatch.setattr(
        renderer, "environment_map", lambda scene, rows: (1.0 + d @ u).astype(np.float32)[..., None] * 1.0
    )
    monkeypatch.setattr(
        renderer, "background_image", lambda scene, camera, w: np.zeros((w.height, w.width, 3), np.float32)
    )
    cube = trimesh.creation.box((4.0, 4.0, 4.0))
    dark = SunSpec((0.0, 0.0, 1.0), visible_fraction=0.0)
    earth = EarthSpec((0.0, 0.0, -7e6), (1.0, 0.0, 0.0, 0.0))
    config = CyclesConfig(samples=256, bounces=0)
    with CyclesRenderer(make_target([cube], [Material(albedo=(0.6, 0.6, 0.6), ior=1.0)]), config) as cycles:
        for n in np.vstack([np.eye(3), -np.eye(3)]):
            scene = replace(make_scene(CAMERA, looking_from(n), dark), earth=earth)
            found = cycles.render(scene).radiance[12:20, 12:20].mean()
            assert found == pytest.approx(0.6 * (1.0 + 2.0 / 3.0 * u @ n), rel=0.02)


def test_textures_lie_with_row_zero_at_v_zero_and_repeat_by_the_tile(make_target, make_scene, monkeypatch):
    albedo = np.zeros((2, 2, 3), np.float32)
    albedo[0, 0], albedo[0, 1], albedo[1, 0] = (0.9, 0, 0), (0, 0.9, 0), (0, 0, 0.9)
    albedo = albedo.repeat(16, axis=0).repeat(16, axis=1)
    flat = np.zeros((32, 32), np.float32)
    texture = PartTexture(4.0, albedo, flat, flat + 0.5, 1.0, None)
    monkeypatch.setattr(materials, "part_textures", lambda *_: (texture,))
    # uv = (x, y), so u in [0, 2) m is texel column 0 and v in [0, 2) m is row 0; negative ones are a tile further
    with CyclesRenderer(make_target([PLATE], [Material()]), CyclesConfig(samples=4)) as cycles:
        image = cycles.render(make_scene(CAMERA, T_FACING)).radiance
    upper_right, lower_right, lower_left = image[11, 21], image[21, 21], image[21, 11]  # image up is target +y
    assert np.argmax(upper_right) == 0
    assert np.argmax(lower_right) == 2
    assert lower_left.max() < 1e-3
    assert np.argmax(image[11, 11]) == 1


@pytest.mark.parametrize(("tilt", "sun"), [((0.5, 0.0), (1.0, 0.0, 1.0)), ((0.0, -0.4), (0.0, -1.0, 1.0))])
def test_normal_maps_tilt_along_u_and_v(tilt, sun, make_target, make_scene, monkeypatch):
    n = np.array([*tilt, np.sqrt(1.0 - tilt[0] ** 2 - tilt[1] ** 2)])
    flat = np.zeros((4, 4), np.float32)
    white = np.ones((4, 4, 3), np.float32)
    texture = PartTexture(1.0, white, flat, flat + 0.5, 1.0, white * n.astype(np.float32))
    monkeypatch.setattr(materials, "part_textures", lambda *_: (texture,))
    s = np.array(sun) / np.linalg.norm(sun)
    scene = make_scene(CAMERA, T_FACING, SunSpec(tuple(s.tolist()), 1.0, WHITE_SUN))
    with CyclesRenderer(make_target([PLATE], [Material()]), CyclesConfig(samples=4)) as cycles:
        found = cycles.render(scene).radiance[14:18, 14:18].mean()
    assert found == pytest.approx((n @ s) / np.pi, rel=0.01)


def test_new_textures_replace_the_old_ones_every_time(make_target, make_scene, monkeypatch):
    flat = np.zeros((64, 64), np.float32)

    def grey(target, strength, seed):
        return (PartTexture(1.0, np.full((64, 64, 3), seed / 20, np.float32), flat, flat + 0.5, 1.0, None),)

    monkeypatch.setattr(materials, "part_textures", grey)
    with CyclesRenderer(make_target([PLATE], [Material()]), CyclesConfig(samples=1)) as cycles:
        for seed in range(1, 21):
            scene = make_scene(CAMERA, T_FACING, SunSpec((0.0, 0.0, 1.0), 1.0, WHITE_SUN))
            scene = replace(scene, texture=replace(scene.texture, strength=1.0, seed=seed))
            assert cycles.render(scene).radiance[16, 16, 0] == pytest.approx(seed / 20 / np.pi, rel=1e-3)
