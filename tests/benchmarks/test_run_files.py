"""Single Monte Carlo runs survive the disc, and never stand for runs of other options."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from navigation.flights import CAMERA, TIGHT, reference
from proxnav.benchmarks.monte_carlo import Case, RunJob, judge_fault, run_case, summarise
from proxnav.benchmarks.run_files import fingerprint, read_runs, write_runs
from proxnav.flight.simulate import SimulationConfig
from proxnav.flight.truth import TruthConfig
from proxnav.navigation.config import NavigationConfig


@pytest.fixture(scope="module")
def job() -> RunJob:
    simulation = SimulationConfig(TruthConfig(step_s=1.0))
    return RunJob(reference(200.0), 180.0, "space-rider", CAMERA, simulation, TIGHT)


def test_runs_come_back_as_they_were_and_only_for_the_same_options(job: RunJob, tmp_path: Path) -> None:
    results = {seed: run_case(Case("wrong", seed, "wrong_frames"), job) for seed in (3, 4)}
    path = tmp_path / "runs" / "wrong.npz"
    write_runs(path, results, fingerprint(job))
    back = read_runs(path, fingerprint(job))
    assert list(back) == [3, 4]
    for seed, result in results.items():
        np.testing.assert_array_equal(back[seed].errors, result.errors)
        assert back[seed].nis == result.nis
        assert back[seed].starts == result.starts
    assert summarise(list(back.values())) == summarise(list(results.values()))
    assert read_runs(path, fingerprint(replace(job, filter=NavigationConfig(coupling="loose")))) == {}
    assert read_runs(tmp_path / "none.npz", fingerprint(job)) == {}


def test_a_run_is_judged_by_plain_numbers(job: RunJob) -> None:
    found = judge_fault([run_case(Case("wrong", 5, "wrong_frames"), job)])
    assert found["end_inside"] + found["end_outside_and_said"] + found["end_outside_unnoticed"] == 1
    assert all(type(value) in (int, float) for value in found.values())
