"""Trust calibrated on trials: how probable hazard is under which evidence, and how large errors get."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float

from proxnav.pose.trust import TrustCalibration, TrustConfig
from proxnav.pose.trust.evidence import Doubts, doubt_rows
from proxnav.pose.trust.hazard import fitted_hazard, usual_doubts
from proxnav.pose.trust.protection import calibrated_protection
from proxnav.pose.trust.verdict import TrustModel, verdict_of
from proxnav.pose.trust.widening import fitted_widening
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
    usual = usual_doubts(_doubts(seen)[~_hazards(seen)])
    told, untold = _model(seen, RISK_TOLD, usual), _model(poses, RISK_UNTOLD, usual)
    return TrustCalibration(told, untold, usual, len(poses))


def _model(poses: Sequence[TrialResult], risk: float, usual: Doubts) -> TrustModel:
    """Covariances and levels are those of the poses that are accepted and show the target."""
    doubts = _doubts(poses)
    hazard = fitted_hazard(doubts, _hazards(poses), risk)
    probable = hazard.probabilities(doubts)
    kept = [k for k, one in enumerate(poses) if one.has_truth and probable[k] <= hazard.limit]
    widening = fitted_widening(doubts[kept], np.array([poses[k].nees for k in kept]), usual)
    honest = np.array([poses[k].covariance for k in kept]) * widening.factors(doubts[kept])[:, None, None]
    errors = np.array([poses[k].errors for k in kept])
    return TrustModel(hazard, widening, calibrated_protection(errors, honest, probable[kept], PROTECTION_RISK))


def _doubts(poses: Sequence[TrialResult]) -> Float[np.ndarray, "n doubts=7"]:
    return doubt_rows([one.evidence for one in poses if one.evidence is not None])


def _is_compared(one: TrialResult, config: TrustConfig) -> bool:
    return one.evidence is not None and verdict_of(one.evidence.view, config) != "not_verifiable"


def _hazards(poses: Sequence[TrialResult]) -> np.ndarray:
    return np.array([one.is_hazardous for one in poses], dtype=bool)
