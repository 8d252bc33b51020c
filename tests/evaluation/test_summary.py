"""Many frames in few numbers."""

import json
from dataclasses import replace

import numpy as np
import pytest
from tests.evaluation.records import disturbed, truth_along

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError
from proxnav.evaluation.error_tables import range_table, table1
from proxnav.evaluation.metrics import metrics
from proxnav.evaluation.pairing import pair
from proxnav.evaluation.summary import by_range, mean_interval, summarise
from proxnav.geometry import Pose

CONTRACT = (
    "frames", "poses", "mean_e_t_m", "mean_e_t_norm_m", "mean_e_r_deg", "mean_e_tn", "mean_e_c", "median_e_r_deg",
    "p95_e_r_deg", "median_e_t_norm_m", "hazardous",
)  # fmt: skip


def at(name: str, t_m: list[float], turn_deg: float = 0.0) -> PoseRecord:
    half = np.radians(turn_deg) / 2.0
    return PoseRecord(name, Pose.from_wxyz("cam", "target", [np.cos(half), 0.0, np.sin(half), 0.0], t_m))


def two_frames() -> tuple[dict[str, PoseRecord], dict[str, PoseRecord]]:
    truth = {"a": at("a", [0.0, 0.0, 10.0]), "b": at("b", [0.0, 0.0, 20.0]), "c": at("c", [0.0, 0.0, 30.0])}
    estimates = {
        "a": at("a", [0.3, 0.0, 10.4], 2.0),
        "b": at("b", [0.0, -1.0, 20.0], 120.0),
        "c": PoseRecord("c", None, "no_consensus"),
    }
    return estimates, truth


def test_means_by_hand_and_frames_without_a_pose_are_counted() -> None:
    s = summarise(*two_frames())
    assert (s.frames, s.poses, s.half_turns) == (3, 2, 1)
    np.testing.assert_allclose(s.mean_e_t_m, [0.15, 0.5, 0.2], atol=1e-12)  # m
    assert s.mean_e_t_norm_m == pytest.approx(0.75)
    assert s.mean_e_r_deg == pytest.approx(61.0)
    assert s.mean_e_tn == pytest.approx(0.05)
    assert s.mean_e_c == pytest.approx(0.05 + np.radians(61.0))
    assert s.median_e_t_norm_m == pytest.approx(0.75)
    assert s.statuses == {"ok": 2, "no_consensus": 1}


@pytest.mark.parametrize(
    ("z_m", "turn_deg", "sigma", "hazardous"),
    [(10.0, 1.0, 1.0, 0), (10.0, 6.0, 1.0, 1), (10.6, 0.0, 1.0, 1), (10.0, 1.0, 1e-3, 1), (10.0, 1.0, None, 0)],
)
def test_a_pose_is_hazardous_by_its_size_or_by_what_it_claims(
    z_m: float, turn_deg: float, sigma: float | None, hazardous: int
) -> None:
    covariance = None if sigma is None else sigma**2 * np.eye(6)
    estimate = replace(at("a", [0.0, 0.0, z_m], turn_deg), covariance=covariance)
    assert summarise({"a": estimate}, {"a": at("a", [0.0, 0.0, 10.0])}).hazardous == hazardous


def test_an_image_that_the_estimates_do_not_know_is_missing() -> None:
    estimates, truth = two_frames()
    del estimates["a"]
    s = summarise(estimates, truth)
    assert s.poses == 1
    assert s.statuses == {"missing": 1, "ok": 1, "no_consensus": 1}


def test_an_estimate_without_truth_is_refused() -> None:
    estimates, truth = two_frames()
    with pytest.raises(InputError, match="1 of 4 estimates, first 'd', have no truth"):
        summarise(estimates | {"d": at("d", [0.0, 0.0, 1.0])}, truth)
    with pytest.raises(InputError, match="no pose for 'c'"):
        summarise({}, truth | {"c": PoseRecord("c", None, "no_pose")})
    with pytest.raises(InputError, match="holds no poses"):
        summarise({}, {})


def test_no_pose_at_all_gives_null_in_json_and_a_table() -> None:
    _, truth = two_frames()
    s = summarise({}, truth)
    content = json.loads(json.dumps(metrics(s), allow_nan=False))
    assert content["poses"] == 0
    assert content["mean_e_c"] is None
    assert "0 poses in 3 frames" in table1(s)


def test_json_holds_the_keys_of_the_contract(rng: np.random.Generator) -> None:
    truth = truth_along(rng, np.linspace(10.0, 100.0, 20))
    content = json.loads(json.dumps(metrics(summarise(truth, truth)), allow_nan=False))
    assert set(CONTRACT) <= set(content)
    assert len(content["mean_e_t_m"]) == 3
    assert content["mean_e_c"] == pytest.approx(0.0, abs=1e-9)


def test_interval_of_a_mean_covers_it_nineteen_times_in_twenty(rng: np.random.Generator) -> None:
    covered = 0
    for _ in range(200):
        low, high = mean_interval(rng.normal(3.0, 1.0, 100), resamples=300)
        covered += low <= 3.0 <= high
    assert 180 <= covered <= 199
    assert np.isnan(mean_interval(np.array([]))).all()


def test_bins_hold_every_frame_once(rng: np.random.Generator) -> None:
    truth = truth_along(rng, rng.uniform(10.0, 100.0, 60))
    frames = pair(disturbed(truth, 1e-4 * np.eye(6), rng), truth)
    bins = by_range(frames, (0.0, 20.0, 50.0, 100.0, 500.0))
    assert sum(s.frames for s in bins.values()) == 60
    assert (100.0, 500.0) not in bins
    assert range_table(bins).count("\n") == len(bins) + 1


def test_table_puts_the_studys_numbers_beside_ours() -> None:
    text = table1(summarise(*two_frames()))
    row = next(line for line in text.splitlines() if line.startswith("mean E_R"))
    assert row.split()[:5] == ["mean", "E_R", "deg", "4.302", "61"]
    row = next(line for line in text.splitlines() if line.startswith("mean E_C"))
    assert "0.1345" in row
    assert "2 poses in 3 frames (66.7 %); without a pose: 1 no_consensus" in text
    assert "half-turn confusions (E_R > 90 deg): 1" in text
