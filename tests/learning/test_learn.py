"""`learn`."""

from pathlib import Path

import pytest

from proxnav.errors import InputError
from proxnav.learning.learn import Effort, learn
from proxnav.missions import MISSION, load_mission, write_mission


def test_a_folder_that_learns_another_mission_is_left_as_it_is(tmp_path: Path) -> None:
    write_mission(tmp_path / MISSION, load_mission("study"))
    with pytest.raises(InputError, match="learns another mission"):
        learn(load_mission("observation-10-100m"), tmp_path, Effort(), Effort())
    assert load_mission(tmp_path / MISSION) == load_mission("study")


@pytest.mark.parametrize("change", [{"hours": 0.0}, {"hours": float("nan")}, {"calibration": 10}, {"raycast": 0}])
def test_an_effort_that_gives_no_model_is_refused(change) -> None:
    with pytest.raises(InputError):
        Effort(**change)
