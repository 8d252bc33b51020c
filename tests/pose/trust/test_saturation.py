"""White pixels are counted inside the craft, not in the sky."""

import numpy as np
import pytest

from proxnav.geometry import Camera, Pose
from proxnav.geometry.perturbation import moved
from proxnav.pose.trust import saturated_share

CAMERA = Camera(200, 100, 100.0, 100.0, 100.0, 50.0)
AT_TEN_M = moved(Pose.identity("cam", "target"), np.array([0.0, 0.0, 10.0, 0.0, 0.0, 0.0]))
SQUARE = np.array([[x, y, 0.0] for x in (-2.0, 2.0) for y in (-2.0, 2.0)])  # pixels 80 to 120, 30 to 70


def test_only_what_lies_inside_the_craft_counts() -> None:
    grey = np.full((100, 200), 255, np.uint8)
    grey[28:72, 78:122] = 100
    assert saturated_share(grey, CAMERA, AT_TEN_M, SQUARE) == 0.0
    grey[30:70, 80:100] = 254
    assert saturated_share(grey, CAMERA, AT_TEN_M, SQUARE) == pytest.approx(0.5, abs=0.03)


def test_a_craft_outside_of_the_picture_or_behind_the_camera_has_none() -> None:
    grey = np.full((100, 200), 255, np.uint8)
    beside = moved(AT_TEN_M, np.array([90.0, 0.0, 0.0, 0.0, 0.0, 0.0]))
    behind = moved(AT_TEN_M, np.array([0.0, 0.0, -30.0, 0.0, 0.0, 0.0]))
    assert saturated_share(grey, CAMERA, beside, SQUARE) == 0.0
    assert saturated_share(grey, CAMERA, behind, SQUARE) == 0.0
