"""New missions."""

import tomllib

import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.geometry.calibration import CalibrationSigma
from proxnav.missions.draft import Answers, draft
from proxnav.missions.files import parse_mission

CAMERA = Camera(
    640, 480, 700.0, 701.0, 320.0, 239.0, (-0.1, 0.02, 0.0, 0.001, 0.0), "pinhole", CalibrationSigma(0.002, 0.5)
)


def answers(**changes) -> Answers:
    return Answers(**({"name": "tour", "target": "space-rider", "target_radius_m": 6.5, "camera": CAMERA,
                       "sensor": "speed-class", "range_m": (5.0, 60.0)} | changes))  # fmt: skip


def test_the_file_reads_back_as_the_mission_with_the_camera_and_what_is_not_known_of_it() -> None:
    mission, text = draft(answers())
    assert parse_mission(tomllib.loads(text), "tour") == mission
    assert mission.camera == CAMERA
    assert (mission.name, mission.view.range_m, mission.view.roll_deg) == ("tour", (5.0, 60.0), "any")


def test_training_is_wider_than_the_mission() -> None:
    mission, _ = draft(answers(roll_deg=20.0, phase_deg=90.0))
    wider = mission.training_mission
    assert wider.view.range_m[0] < 5.0 < 60.0 < wider.view.range_m[1]
    assert wider.light.phase_deg[1] > 90.0
    assert mission.view.roll_deg == 20.0


@pytest.mark.parametrize("range_m", [(0.0, 5.0), (9.0, 5.0)])
def test_a_range_that_is_none_is_refused(range_m) -> None:
    with pytest.raises(InputError, match="0 < least <= most"):
        draft(answers(range_m=range_m))
