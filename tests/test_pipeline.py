"""The whole chain on four small frames: what it leaves is a run that can be read, reported and continued."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from proxnav import pipeline
from proxnav.errors import InputError
from proxnav.evaluation.run_folder import read_run
from proxnav.frames import FrameConfig
from proxnav.missions import load_mission

RAYCAST = FrameConfig("raycast")


@dataclass(frozen=True)
class Options:
    seed: int = 3


@pytest.mark.slow
def test_a_flown_mission_ends_in_a_report_and_runs_again_to_the_same_numbers(tmp_path: Path) -> None:
    mission = load_mission("spiral-10-100m")
    mission = replace(mission, camera=mission.camera.resized(512, 512))
    outcome = pipeline.run(mission, 4, 3, RAYCAST, "space-rider-fast", tmp_path, Options())
    judgement = outcome.judgement
    assert judgement.summary.poses >= 3
    run = read_run(tmp_path)
    assert len(run.frames) == 4
    assert outcome.solution is not None
    assert (outcome.solution.starts, outcome.solution.doubts) == (1, ())
    assert run.solution is not None
    assert np.nanmedian(np.linalg.norm(run.solution.errors[:, :3], axis=1)) < 1.0  # m, at 20 to 70 m
    assert run.config["options"] == {"seed": 3}
    assert (tmp_path / "report.html").stat().st_size > 10_000
    again = pipeline.run(mission, 4, 3, RAYCAST, "space-rider-fast", tmp_path, Options())
    assert again.judgement.metrics() == judgement.metrics()


def test_a_mission_without_a_trajectory_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no trajectory to fly"):
        pipeline.run(load_mission("study"), 4, 0, RAYCAST, "space-rider", tmp_path, Options())
