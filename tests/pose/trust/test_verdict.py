"""All evidence amounts to one status that says why, and to levels that say how wrong a pose can be."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.pose.trust import Evidence, Similarity, TrustCalibration, TrustConfig, judged
from proxnav.pose.trust.evidence import Doubts, doubt_rows
from proxnav.pose.trust.hazard import HazardModel, usual_doubts
from proxnav.pose.trust.protection import ProtectionFactors
from proxnav.pose.trust.verdict import TrustModel
from proxnav.pose.trust.widening import Widening

GOOD = Evidence(0.995, 0.75, 0.02, 0.004, 0.8, Similarity(0.88, 0.1))
TOLD = HazardModel(-10.0, 1.0, 1.0, 0.5, 0.1, 0.5, 3.0, 0.1, limit=0.05, expected_risk=1e-3)
UNTOLD = HazardModel(5.0, 1.5, 1.5, 1.5, 0.1, 0.5, 0.0, 0.1, limit=0.05, expected_risk=5e-3)
USUAL = usual_doubts(doubt_rows([GOOD]))
NO_WEIGHT = Doubts(*[0.0] * len(Doubts._fields))
LEVELS = ProtectionFactors(1e-3, (), ((4.0, 5.0, 6.0),))
WIDER = ProtectionFactors(1e-3, (), ((8.0, 8.0, 8.0),))
KNOWN = TrustConfig(
    range_m=(10.0, 100.0),
    calibration=TrustCalibration(
        TrustModel(TOLD, Widening(0.0, NO_WEIGHT._replace(edges=0.5), USUAL), LEVELS),
        TrustModel(UNTOLD, Widening(float(np.log(4.0)), NO_WEIGHT, USUAL), WIDER),
        USUAL, 100,
    ),
)  # fmt: skip
COVARIANCE = np.diag([0.01, 0.01, 0.04, 1e-4, 1e-4, 1e-4])


def status(evidence: Evidence, range_m: float = 50.0, config: TrustConfig = KNOWN) -> str:
    return judged(evidence, range_m, COVARIANCE, config)[0]


def test_a_good_pose_is_kept_with_its_protection_levels() -> None:
    found, trust, _ = judged(GOOD, 50.0, COVARIANCE, KNOWN)
    assert (found, trust.verdict, trust.risk) == ("ok", "verified", 1e-3)
    assert trust.hazard < 0.05
    np.testing.assert_allclose(trust.protection_m, [0.4, 0.4, 1.0])
    np.testing.assert_allclose(trust.protection_rad, [0.06, 0.06, 0.06])


def test_refusals_say_why() -> None:
    assert status(GOOD.seen(Similarity(0.2, 0.1))) == "unlike_render"
    assert status(Evidence(0.5, 0.2, 0.02, 0.004, 0.8)) == "other_craft"
    assert status(Evidence(0.99, 0.6, 1.5, 0.2, 0.8)) == "ambiguous"
    assert status(GOOD, range_m=300.0) == "outside_mission"
    assert status(GOOD, range_m=2.0) == "outside_mission"


@pytest.mark.parametrize("view", [None, Similarity(0.1, 0.001), Similarity(0.1, 0.1, saturated=0.9)])
def test_without_a_comparable_view_the_other_evidence_decides(view: Similarity | None) -> None:
    found, trust, _ = judged(GOOD.seen(view), 50.0, COVARIANCE, KNOWN)
    assert (found, trust.verdict) == ("ok", "not_verifiable")
    np.testing.assert_allclose(trust.protection_m, [1.6, 1.6, 3.2])


def test_without_a_calibration_only_a_view_that_contradicts_refuses() -> None:
    plain = TrustConfig()
    assert status(GOOD, config=plain) == "ok"
    assert status(GOOD.seen(Similarity(0.2, 0.1)), config=plain) == "unlike_render"
    assert status(Evidence(0.1, 0.1, 1.0, 0.5, 1e-9), config=plain) == "ok"


def test_covariances_are_widened_by_the_evidence_and_only_with_a_calibration() -> None:
    worse = replace(GOOD, edge_share=GOOD.edge_share - 0.2)  # a doubt of edges more by 1
    for evidence, factor in ((GOOD, 1.0), (worse, np.exp(0.5)), (GOOD.seen(None), 4.0)):
        np.testing.assert_allclose(judged(evidence, 50.0, COVARIANCE, KNOWN)[2], factor * COVARIANCE, rtol=2e-3)
    np.testing.assert_array_equal(judged(GOOD, 50.0, COVARIANCE, TrustConfig())[2], COVARIANCE)
