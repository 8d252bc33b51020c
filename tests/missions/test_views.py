"""Which views a mission takes."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.missions.views import NEAREST_M, accepted_views
from proxnav.targets.hull import Hull
from proxnav.targets.loading import load_target

MISSION = load_mission("observation-10-100m")
NEAR = replace(MISSION, view=replace(MISSION.view, range_m=(2.0, 12.0), least_keypoints=4))


def test_a_near_mission_shows_as_many_keypoints_as_it_asks_for_and_stays_outside_the_craft() -> None:
    target = load_target("space-rider")
    hull = Hull.of(target)
    scenes = draw_scenes(NEAR, 40, seed=3)
    for scene in scenes:
        assert scene.camera.contains(scene.camera.project(scene.T_cam_target @ target.keypoints_m)).sum() >= 4
        assert hull.distance_m(scene.T_cam_target.inverse().t_m) >= NEAREST_M
    assert min(np.linalg.norm(scene.t_cam_target_m) for scene in scenes) < 6.0


def test_a_mission_that_asks_for_no_keypoints_takes_every_view() -> None:
    assert accepted_views(MISSION, MISSION.camera) is None


def test_ranges_spread_by_their_logarithm_give_the_near_half_its_share() -> None:
    spread = replace(MISSION, view=replace(MISSION.view, range_m=(10.0, 1000.0), range_spacing="log"))
    ranges = np.array([np.linalg.norm(scene.t_cam_target_m) for scene in draw_scenes(spread, 200, seed=1)])
    assert 0.4 < (ranges < 100.0).mean() < 0.6


def test_the_hull_is_outside_where_a_point_is_and_inside_at_the_origin() -> None:
    hull = Hull.of(load_target("space-rider"))
    assert hull.distance_m(np.zeros(3)) < 0.0
    assert hull.distance_m(np.array([0.0, 0.0, 50.0])) > 40.0


def test_the_way_to_a_port_lies_in_its_cone() -> None:
    docking = load_mission("docking-2-30m")
    T_port_target = load_target("space-rider").frames["docking_port"].inverse()
    for scene in draw_scenes(docking, 20, seed=5):
        x, y, z = T_port_target @ scene.T_cam_target.inverse().t_m
        assert np.degrees(np.arctan2(np.hypot(y, z), x)) <= docking.view.cone_deg


def test_a_port_that_the_target_does_not_have_is_named_with_those_it_has() -> None:
    elsewhere = replace(MISSION, view=replace(MISSION.view, port="berth"))
    with pytest.raises(InputError, match="no frame 'berth', only docking_port"):
        draw_scenes(elsewhere, 1, seed=0)
