"""Random scenes: pure in (seed, index), inside their ranges, and physically consistent."""

import json
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import SUN_HALF_ANGLE, sun_visible_fraction
from proxnav.records import SceneSpec, SensorSpec
from proxnav.scenes import RandomSceneConfig, SunConfig, ViewpointConfig, random_scene
from proxnav.scenes.random_view import sees_earth

CAMERA = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0, (-0.1, 0.05, 1e-4, -1e-4, 0.0))
HORIZON = np.arccos(6371.0 / 6771.0)


def scenes(config=None, count=150, seed=3, camera=CAMERA):
    return [random_scene(i, seed, config or RandomSceneConfig(), "space-rider", camera) for i in range(count)]


def nadir(scene):
    return unit(np.array(scene.earth.r_target_earth_m))


@settings(max_examples=15, deadline=None)
@given(st.integers(0, 2**40), st.integers(0, 2**31))
def test_a_scene_is_a_pure_function_of_seed_and_index_and_survives_json(seed, index):
    scene = random_scene(index, seed, RandomSceneConfig(), "space-rider", CAMERA)
    assert scene == random_scene(index, seed, RandomSceneConfig(), "space-rider", CAMERA)
    assert SceneSpec.from_json(json.loads(json.dumps(scene.to_json()))) == scene


def test_neighbouring_scenes_and_seeds_differ():
    assert len({s.q_cam_target for s in scenes(count=50)} | {s.q_cam_target for s in scenes(count=50, seed=4)}) == 100


def test_range_is_uniform_between_its_limits():
    ranges = np.sort([np.linalg.norm(s.t_cam_target_m) for s in scenes(count=400)])
    uniform = 10.0 + 90.0 * (np.arange(400) + 0.5) / 400
    assert ranges.min() >= 10.0
    assert ranges.max() <= 100.0
    assert np.abs(ranges - uniform).max() / 90.0 < 1.63 / 20.0  # Kolmogorov-Smirnov, 99 %


def test_viewpoints_are_uniform_on_the_sphere():
    outward = np.array([unit(s.T_cam_target.inverse().t_m) for s in scenes(count=400)])
    assert np.abs(outward.mean(axis=0)).max() < 3.0 * np.sqrt(1.0 / 3.0 / 400)
    assert np.abs(outward.T @ outward / 400 - np.eye(3) / 3.0).max() < 0.06


def test_the_target_stays_inside_except_for_the_partial_share():
    config = RandomSceneConfig(view=ViewpointConfig(range_m=(30.0, 100.0), partial_share=0.0))
    for scene in scenes(config, count=100):
        u, v = CAMERA.project(np.array(scene.t_cam_target_m))
        reach = 1407.0 * 5.0 / np.linalg.norm(scene.t_cam_target_m)
        assert min(u, v) - reach > -1.0
        assert max(u, v) + reach < 1025.0
    cut = RandomSceneConfig(view=ViewpointConfig(range_m=(30.0, 100.0), partial_share=1.0))
    pixels = np.array([CAMERA.project(np.array(s.t_cam_target_m)) for s in scenes(cut, count=150)])
    assert (np.abs(pixels - 512.0) > 480.0).any(axis=1).mean() == pytest.approx(1 - (480 / 512) ** 2, abs=0.09)


def test_limited_roll_keeps_the_zenith_up():
    centred = ViewpointConfig(roll_limit_rad=0.2, partial_share=0.0, target_radius_m=1e3, least_offset=0.0)
    rolls = []
    for scene in scenes(RandomSceneConfig(view=centred), count=150):
        right, down, _ = scene.T_cam_target.R @ nadir(scene)
        rolls.append(np.arctan2(right, down))
    assert np.abs(rolls).max() < 0.2 + 1e-9
    assert np.abs(rolls).max() > 0.18


@pytest.mark.parametrize(("umbra", "penumbra"), [(0.0, 0.0), (0.3, 0.2), (0.0, 1.0)])
def test_light_comes_in_the_configured_shares(umbra, penumbra):
    config = RandomSceneConfig(sun=SunConfig(umbra_share=umbra, penumbra_share=penumbra))
    visible = np.array([s.sun.visible_fraction for s in scenes(config, count=150)])
    assert (visible == 0.0).mean() == pytest.approx(umbra, abs=0.11)
    assert ((visible > 0.0) & (visible < 1.0)).mean() == pytest.approx(penumbra, abs=0.11)


def test_the_visible_fraction_follows_from_the_geometry():
    config = RandomSceneConfig(sun=SunConfig(umbra_share=0.3, penumbra_share=0.4), tumbling_share=0.5)
    for scene in scenes(config, count=100):
        r = -np.array(scene.earth.r_target_earth_m)
        expected = sun_visible_fraction(r, np.array(scene.sun.direction_target))
        assert scene.sun.visible_fraction == pytest.approx(expected, abs=1e-6)


def test_lamps_come_in_their_share_and_leave_all_else_as_it_is():
    plain, lit = scenes(count=80), scenes(RandomSceneConfig(sun=SunConfig(lamp_share=0.4)), count=80)
    assert [replace(s, sun=p.sun) for s, p in zip(lit, plain, strict=True)] == plain
    radii = np.array([s.sun.half_angle_rad for s in lit])
    assert (radii > SUN_HALF_ANGLE).mean() == pytest.approx(0.4, abs=0.13)
    assert radii.max() <= 0.5


def test_the_phase_limit_keeps_the_sun_behind_the_camera():
    config = RandomSceneConfig(sun=SunConfig(max_phase_rad=1.0))
    for scene in scenes(config, count=100):
        to_camera = unit(scene.T_cam_target.inverse().t_m)
        assert to_camera @ np.array(scene.sun.direction_target) > np.cos(1.0) - 1e-9


def test_earth_is_in_about_half_of_the_pictures_by_geometry():
    seen = [sees_earth(s.T_cam_target, nadir(s), CAMERA, HORIZON) for s in scenes(count=100)]
    assert np.mean(seen) == pytest.approx(0.54, abs=0.1)


@pytest.mark.parametrize("share", [0.0, 0.8, 1.0])
def test_earth_share_is_kept(share):
    config = RandomSceneConfig(earth_share=share, tumbling_share=0.3)
    seen = [sees_earth(s.T_cam_target, nadir(s), CAMERA, HORIZON) for s in scenes(config, count=80)]
    assert np.mean(seen) == pytest.approx(share, abs=0.12)


def test_the_target_flies_lvlh_fixed_at_its_altitude_over_all_of_earth():
    drawn = scenes(RandomSceneConfig(attitude_sigma_rad=0.01), count=150)
    assert np.degrees(np.arccos([nadir(s)[2] for s in drawn])).max() < 3.0
    heights = [np.linalg.norm(s.earth.r_target_earth_m) - 6371008.8 for s in drawn]
    assert heights == pytest.approx([400e3] * 150)
    below = np.array(
        [quaternion.rotate(quaternion.conjugate(np.array(s.earth.q_target_ecef)), -nadir(s)) for s in drawn]
    )
    assert np.abs(below.mean(axis=0)).max() < 3.0 * np.sqrt(1.0 / 3.0 / 150)


def test_appearance_does_not_depend_on_the_geometry_options():
    plain = random_scene(7, 1, RandomSceneConfig(), "space-rider", CAMERA)
    limited = random_scene(7, 1, RandomSceneConfig(sun=SunConfig(max_phase_rad=0.7)), "space-rider", CAMERA)
    assert plain.texture == limited.texture
    assert plain.earth.cloud_seed == limited.earth.cloud_seed
    assert plain.sun != limited.sun or plain.q_cam_target == limited.q_cam_target


def test_the_sensor_is_drawn_by_the_callable():
    draw = lambda rng: SensorSpec(name="drawn", read_noise_e=rng.uniform(2.0, 8.0))  # noqa: E731
    first, second = (random_scene(i, 1, RandomSceneConfig(), "space-rider", CAMERA, draw) for i in range(2))
    assert first.sensor.name == "drawn"
    assert first.sensor != second.sensor
    assert first.sensor == random_scene(0, 1, RandomSceneConfig(), "space-rider", CAMERA, draw).sensor


def test_a_black_sky_has_no_earth_and_the_same_view():
    dark = random_scene(0, 1, RandomSceneConfig(earth=False), "space-rider", CAMERA)
    assert dark.earth is None
    assert dark.q_cam_target == random_scene(0, 1, RandomSceneConfig(), "space-rider", CAMERA).q_cam_target


def test_impossible_wishes_are_refused_in_one_sentence(monkeypatch):
    monkeypatch.setattr(import_module("proxnav.scenes.random_scene"), "_MAX_TRIES", 50)
    with pytest.raises(InputError, match=r"widen the phase angles"):
        random_scene(0, 1, RandomSceneConfig(sun=SunConfig(max_phase_rad=0.0)), "space-rider", CAMERA)
    with pytest.raises(InputError, match="sum to 1 at most"):
        SunConfig(umbra_share=0.7, penumbra_share=0.7)
    with pytest.raises(InputError, match="0 < least <= most"):
        ViewpointConfig(range_m=(100.0, 10.0))
