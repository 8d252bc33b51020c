"""Trust calibrated on trials: how probable hazard is under which evidence, and how large errors get."""

from collections.abc import Sequence

import numpy as np

from proxnav.pose.trust import TrustCalibration, TrustConfig
from proxnav.pose.trust.evidence import doubt_rows
from proxnav.pose.trust.hazard import HazardModel, fitted_hazard, usual_doubts
from proxnav.pose.trust.protection import ProtectionFactors, calibrated_protection
from proxnav.pose.trust.verdict import verdict_of
from proxnav.trials.conditions import teaches
from proxnav.trials.results import TrialResult, with_pose

RISK_TOLD, RISK_UNTOLD = 1e-3, 5e-3
"""Share of hazardous poses among the accepted ones that is aimed at, with the Sun told and without."""
PROTECTION_RISK = 1e-3
_FEWEST_WRONG, _FEWEST_GOOD = 4, 20


def calibrated_trust(results: Sequence[TrialResult], config: TrustConfig) -> TrustCalibration | None:
    """From trials under the conditions that teach; None where too few poses are good or hazardous."""
    teaching = [one for one in with_pose(results) if teaches(one.condition)]
    poses = [one.untold() for one in teaching]
    seen = [one.told() for one in teaching if _is_compared(one, config)]
    wrong = int(_hazards(seen).sum())
    if wrong < _FEWEST_WRONG or len(seen) - wrong < _FEWEST_GOOD:
        return None
    told_by = doubt_rows([one.evidence for one in seen if one.evidence is not None])
    untold_by = doubt_rows([one.evidence for one in poses if one.evidence is not None])
    with_sun = fitted_hazard(told_by, _hazards(seen), RISK_TOLD)
    without = fitted_hazard(untold_by, _hazards(poses), RISK_UNTOLD)
    return TrustCalibration(
        told=with_sun, untold=without, usual=usual_doubts(told_by[~_hazards(seen)]),
        protection_told=_protection(seen, with_sun, told_by), protection_untold=_protection(poses, without, untold_by),
        frames=len(poses),
    )  # fmt: skip


def _is_compared(one: TrialResult, config: TrustConfig) -> bool:
    return one.evidence is not None and verdict_of(one.evidence.view, config) != "not_verifiable"


def _hazards(poses: Sequence[TrialResult]) -> np.ndarray:
    return np.array([one.is_hazardous for one in poses], dtype=bool)


def _protection(poses: Sequence[TrialResult], model: HazardModel, doubts: np.ndarray) -> ProtectionFactors:
    """Factors from the poses that the model accepts and that show the target."""
    hazards = model.probabilities(doubts)
    kept = [k for k, one in enumerate(poses) if one.has_truth and hazards[k] <= model.limit]
    errors = np.array([poses[k].errors for k in kept])
    covariances = np.array([poses[k].covariance for k in kept])
    return calibrated_protection(errors, covariances, hazards[kept], PROTECTION_RISK)
