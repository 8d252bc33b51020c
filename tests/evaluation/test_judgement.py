"""Estimates beside the truth of a rendered set."""

from dataclasses import replace

from proxnav.evaluation.judgement import judge, truth_of


def test_perfect_estimates_have_no_error(six):
    judgement = judge([replace(record, status="ok") for record in truth_of(six)], six)
    assert judgement.summary.poses == 6
    assert judgement.summary.mean_e_c < 1e-9
    assert judgement.efficiency
    assert all(one.translation < 1e-6 < one.bound_t_m for one in judgement.efficiency.values())
    assert set(judgement.metrics()["efficiency"]) == {f"{a:g}-{b:g} m" for a, b in judgement.efficiency}
    assert "Cramer-Rao" in judgement.text()
