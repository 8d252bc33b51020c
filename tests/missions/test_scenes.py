"""Scenes of a mission: functions of seed and number, where the target shows its lit side."""

import re
from dataclasses import replace

import numpy as np
import pytest

from proxnav.errors import InputError, InputNote
from proxnav.missions import fly, load_mission
from proxnav.missions.daylight import eclipse_line, in_light
from proxnav.missions.files import shipped_missions
from proxnav.missions.scenes import draw_scenes, follow
from proxnav.trajectories import ApproachConfig, FlightConfig, HoldConfig, OrbitConfig, hold, straight_approach
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


IN_SHADOW = FlightConfig(orbit=OrbitConfig(argument_of_latitude_deg=0.0))
APPROACH = load_mission("approach-100-10m")


@pytest.mark.parametrize("name", [n for n in shipped_missions() if load_mission(n).flight.trajectory])
def test_every_shipped_flight_has_frames_in_the_light_that_its_mission_wants(name):
    mission = load_mission(name)
    flight = fly(mission.flight.trajectory)
    assert observable(flight, mission.scenes.sun.max_phase_rad).any()
    if len(flight) < 1000:  # minutes, not orbits
        assert observable(flight, mission.scenes.sun.max_phase_rad).all()


def test_a_flight_in_eclipse_throughout_is_refused_in_a_sentence_that_says_what_to_do():
    dark = straight_approach(ApproachConfig(step_s=10.0), IN_SHADOW)
    with pytest.raises(
        InputError, match=r"in eclipse at all 61 instants from 2024-11-01T00:00:00Z on, every frame"
    ) as e:
        follow(dark, APPROACH, 5, seed=0, size=SIDE)
    assert "begin elsewhere on the orbit (argument_of_latitude_deg)" in str(e.value)
    assert "\n" not in str(e.value)


def test_who_wants_eclipse_gets_it_and_is_told_how_much():
    dark = straight_approach(ApproachConfig(step_s=10.0), IN_SHADOW)
    wanted = replace(APPROACH, light=replace(APPROACH.light, umbra=0.1))
    assert eclipse_line(follow(dark, wanted, 5, seed=0, size=SIDE)) == "5 of 5 frames in eclipse"
    part = fly("spiral-10-100m")
    scenes = follow(part, wanted, 20, seed=0, size=SIDE)
    eclipsed = int(re.match(r"(\d+) of 20 frames in eclipse", eclipse_line(scenes))[1])
    assert eclipsed == pytest.approx(20 * (part.sun_visible <= 0.5).mean(), abs=1.5)
    assert eclipse_line(follow(part, load_mission("spiral-10-100m"), 20, seed=0, size=SIDE)) == ""


def test_a_flight_lit_from_the_side_alone_is_followed_with_a_note_and_one_lit_from_behind_is_refused():
    ahead = hold(
        HoldConfig(step_s=60.0, duration_s=600.0), FlightConfig(orbit=OrbitConfig(argument_of_latitude_deg=175.0))
    )
    with pytest.warns(InputNote, match=r"never within 90 deg from behind the camera"):
        assert len(in_light(ahead, APPROACH)) == len(ahead)
    sun = ahead.sun_eci[0]
    behind = replace(ahead, r_eci_chaser_m=ahead.r_eci_target_m - 30.0 * sun)
    with pytest.raises(InputError, match="in eclipse or lit from behind alone"):
        in_light(behind, APPROACH)


def test_fewer_frames_than_asked_for_are_said():
    few = hold(
        HoldConfig(step_s=300.0, duration_s=600.0), FlightConfig(orbit=OrbitConfig(argument_of_latitude_deg=250.0))
    )
    with pytest.warns(InputNote, match="3 of its 3 instants .* fewer than the 5 frames asked for"):
        assert len(follow(few, APPROACH, 5, seed=0, size=SIDE)) == 3
