"""Scenes of a mission: functions of seed and number, where the target shows its lit side."""

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.missions import fly, load_mission
from proxnav.missions.scenes import draw_scenes, follow
from proxnav.trajectories.selection import observable

SIDE = 96


def scenes(frames, seed=3):
    return draw_scenes(load_mission("observation-10-100m"), frames, seed, SIDE)


def test_the_first_scenes_of_a_longer_set_are_those_of_a_shorter_one():
    assert scenes(3) == scenes(6)[:3]


def test_a_trajectory_is_followed_where_the_lit_side_shows():
    mission = load_mission("spiral-10-100m")
    trajectory = fly(mission.flight.trajectory)
    usable = observable(trajectory, mission.scenes.sun.max_phase_rad)
    assert 0.1 < usable.mean() < 0.9
    for scene in follow(trajectory, mission, 5, seed=0, size=SIDE):
        to_camera = scene.T_cam_target.inverse().t_m
        assert scene.sun.visible_fraction > 0.5
        assert np.dot(scene.sun.direction_target, to_camera) > -1e-6


@pytest.mark.parametrize(("frames", "seed"), [(0, 0), (-3, 0), (1, -1)])
def test_no_frames_or_a_negative_seed_is_refused_by_random_and_by_flown_scenes(frames, seed):
    mission = load_mission("spiral-10-100m")
    with pytest.raises(InputError, match="at least 1 frame"):
        draw_scenes(mission, frames, seed, SIDE)
    with pytest.raises(InputError, match="at least 1 frame"):
        follow(fly(mission.flight.trajectory), mission, frames, seed, SIDE)


@pytest.mark.parametrize("size", [0, -5, 10**9])
def test_an_image_of_impossible_size_is_refused(size):
    with pytest.raises(InputError, match="longer side"):
        draw_scenes(load_mission("observation-10-100m"), 1, 0, size)
