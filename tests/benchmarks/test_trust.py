"""The table of `benchmark trust` counts what the truth says; its figures show it."""

import numpy as np
import pytest
from tests.trials.made import made, many_made

from proxnav.benchmarks.trust import text, trust_table
from proxnav.benchmarks.trust_figures import save_figures
from proxnav.pose.trust import TrustConfig
from proxnav.trials.calibration import calibrated_trust
from proxnav.viewing.trust_figures import roc_area

RESULTS = [*many_made(40, 6), *(made(k, False, "other craft: tango", has_truth=False) for k in range(3))]


@pytest.fixture(scope="module")
def config() -> TrustConfig:
    return TrustConfig(range_m=(10.0, 100.0), calibration=calibrated_trust(many_made(200, 40, seed=3), TrustConfig()))


def test_rows_count_poses_and_hazards_before_and_after(config: TrustConfig) -> None:
    found = trust_table(RESULTS, config)
    nominal, tango = found["rows"]["nominal"], found["rows"]["other craft: tango"]
    assert (nominal["frames"], nominal["before"]["poses"], nominal["before"]["hazardous"]) == (46, 46, 6)
    assert nominal["told"]["hazardous"] == 0
    assert sum(nominal["told"]["statuses"].values()) == 46 - nominal["told"]["poses"] >= 6
    assert (tango["before"]["poses"], tango["before"]["hazardous"]) == (3, 3)
    overall = found["overall"]["told"]
    assert overall["good"] == 40
    assert overall["accepted"] == nominal["told"]["poses"] + tango["told"]["poses"]
    assert overall["protection_exceeded"] < 0.1
    assert "hardest quarter" in text(found)


def test_a_model_without_calibration_has_a_table_and_says_what_is_missing(tmp_path) -> None:
    assert "train trust" in text(trust_table(RESULTS, TrustConfig()))
    save_figures(RESULTS, TrustConfig(), tmp_path)
    assert not list(tmp_path.iterdir())


def test_figures_are_drawn(config: TrustConfig, tmp_path) -> None:
    save_figures(RESULTS, config, tmp_path)
    assert {path.name for path in tmp_path.iterdir()} == {"roc.png", "stanford_m.png", "stanford_deg.png"}


def test_the_area_under_the_curve_is_the_chance_of_the_right_order() -> None:
    wrong = np.array([True, True, False, False])
    assert roc_area(np.array([4.0, 3.0, 2.0, 1.0]), wrong) == 1.0
    assert roc_area(np.array([1.0, 1.0, 1.0, 1.0]), wrong) == 0.5
    assert roc_area(np.array([1.0, 4.0, 2.0, 3.0]), wrong) == 0.5
