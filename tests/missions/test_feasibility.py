"""What a mission can see."""

from dataclasses import replace

import numpy as np

from proxnav.missions import load_mission
from proxnav.missions.feasibility import feasibility
from proxnav.missions.scenes import draw_scenes
from proxnav.targets.loading import load_target

MISSION = load_mission("observation-10-100m")
TARGET = load_target("space-rider")


def test_accuracy_and_size_fall_with_range_and_lit_missions_are_lit() -> None:
    found = feasibility(MISSION, TARGET, draw_scenes(MISSION, 30, 0))
    sizes, depths = ([getattr(row, name) for row in found.rows] for name in ("target_px", "depth_m"))
    assert sizes == sorted(sizes, reverse=True)
    assert depths == sorted(depths)
    assert (found.umbra, found.penumbra) == (0.0, 0.0)
    assert np.degrees(found.sun_from_axis_rad) > 60.0  # phase angles up to 90 deg, target within 20 deg of the axis
    assert "100.0" in found.text()


def test_a_mission_in_the_dark_says_so() -> None:
    dark = replace(MISSION, light=replace(MISSION.light, umbra=1.0))
    found = feasibility(dark, TARGET, draw_scenes(dark, 10, 0))
    assert found.umbra == 1.0
    assert "100 % in Earth's shadow" in found.text()
    assert np.isnan(found.sun_from_axis_rad)
