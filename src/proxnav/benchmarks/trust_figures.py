"""The figures of `benchmark trust`, drawn from judged trials."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from proxnav.benchmarks.trust import JudgedTrial, judge_trials
from proxnav.pose.trust import TrustConfig
from proxnav.trials.results import TrialResult
from proxnav.viewing.trust_figures import roc, stanford


def save_figures(results: Sequence[TrialResult], config: TrustConfig, out: Path) -> None:
    """roc.png, stanford_m.png and stanford_deg.png; nothing where the model has no calibration."""
    if config.calibration is None:
        return
    told, untold = (judge_trials(results, config, light) for light in ("told", "untold"))
    roc({"Sun told": _signal(told), "no Sun": _signal(untold), "25th percentile of scores": _scores(told)}).savefig(
        out / "roc.png", dpi=90
    )
    kept = [one for one in told if one.is_accepted and one.trial.has_truth]
    if kept:
        wrong = np.array([one.trial.is_hazardous for one in kept])
        stanford(*_worst(kept, slice(0, 3), 1.0), wrong, "m").savefig(out / "stanford_m.png", dpi=90)
        stanford(*_worst(kept, slice(3, 6), 180.0 / np.pi), wrong, "deg").savefig(out / "stanford_deg.png", dpi=90)


def _signal(some: Sequence[JudgedTrial]) -> tuple[np.ndarray, np.ndarray]:
    inside = [one for one in some if np.isfinite(one.trust.hazard)]
    return np.array([one.trust.hazard for one in inside]), np.array([one.trial.is_hazardous for one in inside])


def _scores(some: Sequence[JudgedTrial]) -> tuple[np.ndarray, np.ndarray]:
    known = [(one.trial.evidence, one.trial.is_hazardous) for one in some if one.trial.evidence is not None]
    return np.array([-e.lower_quartile_score for e, _ in known]), np.array([wrong for _, wrong in known])


def _worst(some: Sequence[JudgedTrial], axes: slice, scale: float) -> tuple[np.ndarray, np.ndarray]:
    """Error and level of the axis that comes nearest to its level."""
    errors = np.abs([one.trial.errors for one in some])[:, axes] * scale
    levels = np.array([[*one.trust.protection_m, *one.trust.protection_rad] for one in some])[:, axes] * scale
    worst = np.argmax(errors / levels, axis=1)
    rows = np.arange(len(some))
    return errors[rows, worst], levels[rows, worst]
