"""What `benchmark conditions` changes in a scene is what its name says."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.benchmarks.condition_table import row, table
from proxnav.benchmarks.conditions import (
    blurred,
    conditions,
    is_before_earth,
    storm,
)
from proxnav.geometry.perturbation import moved
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.records import PoseResult
from proxnav.trials.scene_changes import noisier, sun_in_lens, without_target

MISSION = load_mission("observation-10-100m")
SCENE = draw_scenes(MISSION, 1, seed=4)[0]


@pytest.mark.parametrize("pixels", [2.0, 5.0])
def test_the_target_moves_by_so_many_pixels_during_the_exposure(pixels):
    scene = replace(blurred(SCENE, pixels), t_cam_target_m=(0.0, 0.0, 40.0))
    exposure = blurred(scene, pixels).exposure
    start = np.array(scene.t_cam_target_m)
    end = start + exposure.exposure_s * np.array(exposure.v_cam_target_mps)
    shift = scene.camera.project(end) - scene.camera.project(start)
    assert np.linalg.norm(shift) == pytest.approx(pixels, abs=0.01)


def test_noise_grows_by_its_factor_over_the_range_of_the_converter():
    usual, loud = SCENE.sensor, noisier(SCENE, 4.0).sensor
    assert usual.gain_e_per_dn == loud.gain_e_per_dn == 0.0  # the full well fills the converter's range
    over_range = lambda s: np.array([s.read_noise_e, s.dsnu_e, np.sqrt(s.full_well_e)]) / s.full_well_e  # noqa: E731
    np.testing.assert_allclose(over_range(loud), 4.0 * over_range(usual))


def test_conditions_change_what_they_name_and_nothing_else():
    drawn = conditions(MISSION.scenes)
    assert drawn["nominal"][0] == MISSION.scenes
    assert drawn["cut by the frame at 10 m"][0].view.range_m == (10.0, 10.0)
    assert replace(storm(SCENE), sensor=SCENE.sensor) == SCENE


@pytest.mark.parametrize("index", range(4))
def test_the_sun_stands_where_the_condition_wants_it(index):
    scene = draw_scenes(MISSION, index + 1, seed=4)[index]
    lit = sun_in_lens(scene, np.radians(15.0))
    in_camera = scene.T_cam_target.R @ np.array(lit.sun.direction_target)
    assert np.degrees(np.arccos(in_camera[2])) == pytest.approx(15.0, abs=1e-6)
    assert 0.0 <= lit.sun.visible_fraction <= 1.0
    assert replace(lit, sun=scene.sun) == scene


def test_frames_without_a_target_are_of_three_kinds():
    empty = [without_target(scene) for scene in draw_scenes(MISSION, 4, seed=4)]
    assert all(scene.t_cam_target_m[2] < 0.0 for scene in empty)
    assert empty[2].sensor != empty[1].sensor == empty[0].sensor
    towards_sun = [(scene.T_cam_target.R @ np.array(scene.sun.direction_target))[2] for scene in empty]
    assert towards_sun[3] == pytest.approx(np.cos(np.radians(15.0)))


def test_earth_is_behind_a_target_seen_from_above():
    assert SCENE.earth is not None
    ahead = -SCENE.T_cam_target.inverse().t_m
    down = replace(SCENE, earth=replace(SCENE.earth, r_target_earth_m=tuple(ahead / np.linalg.norm(ahead) * 6.8e6)))
    up = replace(SCENE, earth=replace(SCENE.earth, r_target_earth_m=tuple(-ahead / np.linalg.norm(ahead) * 6.8e6)))
    assert is_before_earth(down)
    assert not is_before_earth(up)
    assert not is_before_earth(replace(SCENE, earth=None))


def test_a_row_counts_frames_without_a_pose_and_measures_the_others():
    T = SCENE.T_cam_target
    off = moved(T, np.array([0.0, 0.0, 0.01 * np.linalg.norm(T.t_m), 0.0, np.radians(1.0), 0.0]))
    found = PoseResult("ok", off, np.eye(6), np.ones(24, bool))
    numbers = row([(SCENE, found), (SCENE, PoseResult.failure("no_target", 24))])
    assert (numbers["frames"], numbers["poses"]) == (2, 1)
    assert numbers["mean_e_c"] == pytest.approx(0.01 + np.radians(1.0), rel=1e-6)
    assert numbers["median_e_r_deg"] == pytest.approx(1.0)
    rows = {"nominal": numbers, "dark": row([(SCENE, PoseResult.failure("no_target", 24))])}
    text = table({"rows": rows, "empty_frames": 3, "empty_frames_with_a_pose": 0})
    assert "1/2" in text
    assert "0 of 3 frames" in text
