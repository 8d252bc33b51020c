"""What came of trials is judged by the truth, kept on disk, and calibrates the trust of a model."""

import json
from dataclasses import replace

import numpy as np
import pytest
from tests.trials.made import made, many_made

from proxnav.pose.trust import TrustConfig, judged
from proxnav.records import PoseResult
from proxnav.trials import running
from proxnav.trials.calibration import calibrated_trust
from proxnav.trials.conditions import TWO_CRAFT, UNDECLARED, Condition
from proxnav.trials.results import TrialResult, from_json, to_json
from proxnav.trials.running import TrialRun


def test_a_pose_is_hazardous_by_size_by_covariance_or_by_what_is_not_there() -> None:
    good = made(1, False)
    assert not good.is_hazardous
    assert made(1, True).is_hazardous
    assert replace(good, has_truth=False).is_hazardous
    assert replace(good, covariance=good.covariance * 1e-3).is_hazardous
    assert not replace(good, T_cam_target=None).is_hazardous


@pytest.mark.parametrize("result", [made(2, True), replace(made(3, False), T_cam_target=None, evidence=None)])
def test_results_survive_a_file(result: TrialResult) -> None:
    back = from_json(json.loads(json.dumps(to_json(result))))
    assert (back.key, back.condition, back.status, back.evidence) == (
        result.key, result.condition, result.status, result.evidence,
    )  # fmt: skip
    assert back.is_hazardous == result.is_hazardous
    if result.T_cam_target is not None:
        np.testing.assert_allclose(back.errors, result.errors)


def test_trials_calibrate_a_verdict_that_tells_other_trials_apart() -> None:
    trust = calibrated_trust(many_made(150, 30), TrustConfig())
    assert trust is not None
    assert trust.frames == 180
    config = TrustConfig(calibration=trust)
    for one in many_made(60, 20, seed=5):
        status, found, _ = judged(one.evidence, 50.0, one.covariance, config)
        if status == "ok":
            assert not one.is_hazardous
            assert (np.abs(one.errors) < [*found.protection_m, *found.protection_rad]).all()
    kept = [judged(one.evidence, 50.0, one.covariance, config)[0] == "ok" for one in many_made(60, 0, seed=6)]
    assert np.mean(kept) > 0.9


def test_what_no_picture_shows_is_left_out_and_too_few_poses_calibrate_nothing() -> None:
    unseen = many_made(0, 40, UNDECLARED) + many_made(0, 40, TWO_CRAFT)
    assert calibrated_trust(many_made(100, 0) + unseen, TrustConfig()) is None
    assert calibrated_trust(many_made(10, 10), TrustConfig()) is None


def test_an_interrupted_run_draws_only_what_is_missing(tmp_path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn = []

    def answers(job, scenes, workers, on, name):
        for trial in scenes:
            drawn.append(trial.key)
            failure = PoseResult.failure("no_target", 24)
            yield trial, TrialResult.of(trial, failure, failure, None)

    monkeypatch.setattr(running, "run_anywhere", answers)
    run = TrialRun(mission(), "space-rider", 2, 7, out=tmp_path)
    assert [one.key for one in run.results([Condition("nominal")])] == ["nominal/0", "nominal/1"]
    assert run.kept is not None
    with run.kept.open("a") as file:
        file.write('{"key": "nom')  # a run that was killed while it wrote
    assert len(replace(run, frames=3).results([Condition("nominal")])) == 3
    assert drawn == ["nominal/0", "nominal/1", "nominal/2"]
    replace(run, seed=8, frames=1).results([Condition("nominal")])
    assert drawn[3:] == ["nominal/0"]
    replace(run, frames=3).results([Condition("nominal")])  # those of the first seed are still there
    assert drawn[4:] == []


def mission():
    from proxnav.missions import load_mission

    return load_mission("observation-10-100m")
