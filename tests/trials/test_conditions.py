"""Every condition draws what its name says, as a function of seed and index alone."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.missions import load_mission
from proxnav.targets.loading import load_target
from proxnav.trials.conditions import FOCAL_ERROR, TWO_CRAFT, UNDECLARED, all_conditions, trial_scene
from proxnav.trials.drawing import in_its_place, second_craft
from proxnav.trials.other_shapes import longer_span, turned_wings, without_wing
from proxnav.trials.textures import photograph_like

MISSION = load_mission("observation-10-100m")
CONDITIONS = {one.name: one for one in all_conditions(MISSION)}
RIDER, TANGO = load_target("space-rider"), load_target("tango")


def test_a_scene_is_a_function_of_seed_and_index() -> None:
    one, same = (trial_scene(CONDITIONS["row noise"], MISSION, 3, 2) for _ in range(2))
    assert one == same
    assert one != trial_scene(CONDITIONS["row noise"], MISSION, 4, 2)
    assert one.key == "row noise/2"


def test_conditions_change_what_they_name() -> None:
    plain = trial_scene(CONDITIONS["nominal"], MISSION, 3, 0)
    assert trial_scene(CONDITIONS["over-exposed 16 times"], MISSION, 3, 0).scene.sensor.exposure_bias == 16.0
    assert trial_scene(CONDITIONS["row noise"], MISSION, 3, 0).scene.sensor.row_noise_dn >= 4.0
    assert trial_scene(CONDITIONS["penumbra"], MISSION, 3, 0).scene.sun.visible_fraction < 1.0
    ahead = trial_scene(CONDITIONS["Sun 20-50 deg off the axis"], MISSION, 3, 0).scene
    off_axis = np.degrees(np.arccos((ahead.T_cam_target.R @ np.array(ahead.sun.direction_target))[2]))
    assert 19.99 <= off_axis <= 50.01
    told = trial_scene(CONDITIONS["focal length 1 % off, declared"], MISSION, 3, 0).told
    assert told.fx == pytest.approx(plain.scene.camera.fx * (1.0 + FOCAL_ERROR))
    assert told.calibration_sigma.focal == FOCAL_ERROR
    assert trial_scene(CONDITIONS[UNDECLARED], MISSION, 3, 0).told.calibration_sigma.is_exact
    assert trial_scene(CONDITIONS["stars"], MISSION, 3, 0).scene.earth is None
    assert not trial_scene(CONDITIONS["other craft: tango"], MISSION, 3, 0).has_truth


def test_names_choose_conditions_and_wrong_ones_are_refused() -> None:
    assert {one.shown for one in all_conditions(MISSION, only="modified")} == {"modified target"}
    with pytest.raises(InputError, match="no condition has that in its name"):
        all_conditions(MISSION, only="submarine")


def test_modified_craft_differ_where_they_say() -> None:
    body = np.abs(RIDER.vertices_m[:, 1]) < 1.0
    turned, longer = turned_wings(RIDER, np.radians(30.0)), longer_span(RIDER, 1.14)
    np.testing.assert_allclose(turned.vertices_m[body], RIDER.vertices_m[body], atol=1e-9)
    assert np.ptp(turned.vertices_m[~body][:, 2]) > np.ptp(RIDER.vertices_m[~body][:, 2])
    assert np.ptp(longer.vertices_m[:, 1]) == pytest.approx(1.14 * np.ptp(RIDER.vertices_m[:, 1]))
    missing = without_wing(RIDER)
    middles = missing.vertices_m[missing.faces].mean(axis=1)[:, 1]
    assert middles.max() > 5.0
    assert middles.min() > -1.8


def test_another_craft_stands_where_the_target_would_and_looks_as_large() -> None:
    scene = replace(trial_scene(CONDITIONS["nominal"], MISSION, 3, 1).scene, t_cam_target_m=(1.0, -2.0, 40.0))
    placed = in_its_place(scene, RIDER, TANGO)
    middle = placed.T_cam_target @ (0.5 * (TANGO.vertices_m.min(axis=0) + TANGO.vertices_m.max(axis=0)))
    np.testing.assert_allclose(middle, np.array([1.0, -2.0, 40.0]) * TANGO.size_m / RIDER.size_m)


def test_the_second_craft_is_farther_and_under_the_same_sun() -> None:
    scene = trial_scene(CONDITIONS[TWO_CRAFT], MISSION, 3, 1).scene
    other = second_craft(scene, RIDER, np.random.default_rng(1))
    assert other.t_cam_target_m[2] > scene.t_cam_target_m[2]
    suns = [one.T_cam_target.R @ np.array(one.sun.direction_target) for one in (scene, other)]
    np.testing.assert_allclose(suns[0], suns[1], atol=1e-9)


def test_textures_are_pictures_with_tones() -> None:
    image = photograph_like(replace(MISSION.camera, width=96, height=64), np.random.default_rng(2))
    assert image.shape == (64, 96)
    assert image.dtype == np.uint8
    assert image.std() > 5.0
