"""How often a model is confidently wrong, by condition, before and after its poses are judged."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from proxnav.evaluation.consistency import THREE_SIGMA_NEES
from proxnav.pose.trust import TrustConfig, judged
from proxnav.records.estimates import Trust
from proxnav.trials.results import TrialResult, with_pose

Light = Literal["told", "untold"]
"""Whether the estimator knows where the Sun stands."""


@dataclass(frozen=True, slots=True, eq=False)
class JudgedTrial:
    """A trial with a pose, and its verdict."""

    trial: TrialResult
    status: str
    trust: Trust

    @property
    def is_accepted(self) -> bool:
        """Whether the pose is kept."""
        return self.status == "ok"

    @property
    def over_protection(self) -> float:
        """Largest error over its protection level, of the six axes; NaN without levels."""
        levels = np.array([*self.trust.protection_m, *self.trust.protection_rad])
        return float((np.abs(self.trial.errors) / levels).max())


def judge_trials(results: Sequence[TrialResult], config: TrustConfig, light: Light) -> list[JudgedTrial]:
    """The verdict on every pose, as the estimator would give it."""
    found = []
    for trial in with_pose(results):
        one = trial.told() if light == "told" else trial.untold()
        assert one.evidence is not None and one.T_cam_target is not None and one.covariance is not None  # noqa: PT018
        range_m = float(np.linalg.norm(one.T_cam_target.t_m))
        status, trust, honest = judged(one.evidence, range_m, one.covariance, config)
        found.append(JudgedTrial(replace(one, covariance=honest), status, trust))
    return found


def trust_table(results: Sequence[TrialResult], config: TrustConfig) -> dict[str, Any]:
    """A row for each condition, and numbers over all of them, with the Sun told and without."""
    names = list(dict.fromkeys(one.condition for one in results))
    by_light = {light: judge_trials(results, config, light) for light in ("told", "untold")}
    rows = {name: _row([one for one in results if one.condition == name], name, by_light) for name in names}
    return {"rows": rows, "overall": {light: _overall(some) for light, some in by_light.items()}}


def _row(results: Sequence[TrialResult], name: str, by_light: Mapping[str, Sequence[JudgedTrial]]) -> dict[str, Any]:
    poses = with_pose(results)
    row: dict[str, Any] = {"frames": len(results), "before": _counts(poses)}
    for light, some in by_light.items():
        own = [one for one in some if one.trial.condition == name]
        row[light] = _counts([one.trial for one in own if one.is_accepted])
        row[light]["statuses"] = _statuses(own)
    return row


def _counts(poses: Sequence[TrialResult]) -> dict[str, Any]:
    known = [one for one in poses if one.has_truth]
    counts: dict[str, Any] = {"poses": len(poses), "hazardous": sum(one.is_hazardous for one in poses)}
    if known:
        nees = np.array([one.nees for one in known])
        counts |= {"mean_e_c": float(np.mean([one.e_c for one in known])),
                   "beyond_3_sigma": float(np.mean(nees > THREE_SIGMA_NEES)),
                   "median_nees": float(np.median(nees))}  # fmt: skip
    return counts


def _statuses(some: Sequence[JudgedTrial]) -> dict[str, int]:
    refused = [one.status for one in some if not one.is_accepted]
    return {status: refused.count(status) for status in sorted(set(refused))}


def _overall(some: Sequence[JudgedTrial]) -> dict[str, Any]:
    """Hazard and protection over all conditions; the hardest quarter is that of the most probable hazard."""
    accepted = [one for one in some if one.is_accepted]
    known = [one for one in accepted if one.trial.has_truth and np.isfinite(one.trust.hazard)]
    good = [one for one in some if not one.trial.is_hazardous]
    numbers: dict[str, Any] = {
        "accepted": len(accepted),
        "hazardous": sum(one.trial.is_hazardous for one in accepted),
        "good": len(good),
        "good_refused": sum(not one.is_accepted for one in good),
    }
    if known:
        ratios = np.array([one.over_protection for one in known])
        hard = np.argsort([one.trust.hazard for one in known])[-(len(known) // 4 or 1) :]
        numbers |= {"protection_exceeded": float(np.mean(ratios > 1.0)),
                    "protection_exceeded_hardest_quarter": float(np.mean(ratios[hard] > 1.0)),
                    "median_protection_m": _median(known, "protection_m"),
                    "median_protection_deg": np.degrees(_median(known, "protection_rad")).tolist()}  # fmt: skip
    return numbers


def _median(known: Sequence[JudgedTrial], name: str) -> list[float]:
    return np.median([getattr(one.trust, name) for one in known], axis=0).tolist()


def text(found: Mapping[str, Any]) -> str:
    """The table for people."""
    heads = f"{'before':>14} {'Sun told':>14} {'no Sun':>14}"
    lines = [f"{'':38s} {heads}   refused with the Sun told", f"{'':38s} {'poses, hazardous':>44}"]
    for name, row in found["rows"].items():
        cells = [
            f"{row[k]['poses']:>6}/{row['frames']:<3}{row[k]['hazardous']:>4}" for k in ("before", "told", "untold")
        ]
        why = ", ".join(f"{count} {status}" for status, count in row["told"]["statuses"].items())
        lines.append(f"{name:38s} {' '.join(cells)}   {why}")
    for light, said in (("told", "Sun told"), ("untold", "no Sun")):
        lines.append(f"{said}: {_overall_text(found['overall'][light])}")
    return "\n".join(lines)


def _overall_text(o: Mapping[str, Any]) -> str:
    line = f"{o['hazardous']} of {o['accepted']} accepted poses hazardous, "
    line += f"{o['good_refused']} of {o['good']} good refused"
    if "protection_exceeded" not in o:
        return line + "; no protection levels: the model has no calibration (train trust)"
    m, deg = max(o["median_protection_m"]), max(o["median_protection_deg"])
    over, hard = 100.0 * o["protection_exceeded"], 100.0 * o["protection_exceeded_hardest_quarter"]
    line += f"; protection level exceeded by {over:.2f} % ({hard:.2f} % in the hardest quarter)"
    return line + f", median {m:.2f} m and {deg:.2f} deg"
