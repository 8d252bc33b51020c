"""The benchmark's figures on few cases: errors are firm, times are not."""

from proxnav.benchmarks.solve import benchmark_solve


def test_ours_is_at_least_as_accurate_as_opencv_and_poselib() -> None:
    found = benchmark_solve(cases=200, seed=1)
    for key in ("24_keypoints", "6_keypoints"):
        ours = found[key]["proxnav"]
        assert ours["failures"] <= 1
        for other in ("opencv", "poselib"):
            assert ours["p95_e_r_deg"] < 1.1 * found[key][other]["p95_e_r_deg"]
            assert found[key][other]["time_over_proxnav"] > 0.0


def test_the_same_seed_draws_the_same_cases() -> None:
    a, b = (benchmark_solve(cases=20, seed=5, keypoints=(6,)) for _ in range(2))
    assert a["6_keypoints"]["proxnav"]["mean_e_r_deg"] == b["6_keypoints"]["proxnav"]["mean_e_r_deg"]
