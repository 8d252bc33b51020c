"""What the evidence about a pose amounts to: kept or refused, why, and how wrong it can be."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from proxnav.geometry.types import PoseCovariance
from proxnav.pose.trust.evidence import Doubts, Evidence
from proxnav.pose.trust.hazard import HazardModel
from proxnav.pose.trust.local_correlation import Similarity
from proxnav.pose.trust.protection import ProtectionFactors
from proxnav.pose.trust.widening import Widening
from proxnav.records.estimates import PoseStatus, Trust, Verdict

_WHY: dict[str, PoseStatus] = {
    "scores": "other_craft", "edges": "other_craft", "turn": "ambiguous", "shift": "ambiguous",
    "residuals": "ambiguous", "view": "unlike_render", "saturated": "unlike_render",
}  # fmt: skip
RANGE_SLACK = 1.6
"""Factor on the mission's ranges beyond which a pose is none of that mission: keypoints far beyond err in range."""


@dataclass(frozen=True, slots=True)
class TrustModel:
    """From evidence to a probability of hazard, an honest covariance and protection levels."""

    hazard: HazardModel
    widening: Widening
    protection: ProtectionFactors


@dataclass(frozen=True, slots=True)
class TrustCalibration:
    """What drawn frames taught; `model.json` carries it."""

    told: TrustModel
    """Where the Sun is told and the predicted view can be compared."""
    untold: TrustModel
    """Where it cannot."""
    usual: Doubts
    """Those of good poses."""
    frames: int = 0
    """Poses that it rests on."""


@dataclass(frozen=True, slots=True)
class TrustConfig:
    """Where evidence begins to speak."""

    least_similarity: float = 0.647
    """Similarity of the predicted view that 99 % of good poses exceed."""
    least_contrast: float = 0.02
    """Contrast of the predicted view below which nothing can be compared."""
    most_saturated: float = 0.4
    """Share of the craft's pixels at the end of the scale above which the picture is damaged."""
    range_m: tuple[float, float] | None = None
    """Ranges that the model was made for."""
    calibration: TrustCalibration | None = None
    """None: only the predicted view counts, by `least_similarity`."""


def judged(
    evidence: Evidence, range_m: float, covariance: PoseCovariance, config: TrustConfig
) -> tuple[PoseStatus, Trust, PoseCovariance]:
    """The status of a pose with this evidence, what can be said about it, and its covariance as honest as it can be."""
    verdict = verdict_of(evidence.view, config)
    similarity = float("nan") if evidence.view is None else evidence.view.score
    trust = Trust(verdict, similarity, p_value=evidence.p_value)
    if config.range_m is not None and not _is_inside(range_m, config.range_m):
        return "outside_mission", trust, covariance
    known = config.calibration
    if known is None:
        return ("unlike_render" if verdict == "contradicted" else "ok"), trust, covariance
    compared = verdict != "not_verifiable"
    evidence = evidence if compared else evidence.seen(None)
    model = known.told if compared else known.untold
    hazard, honest = model.hazard.probability(evidence), model.widening.widened(covariance, evidence)
    levels, risk = model.protection.levels(honest, hazard), model.protection.risk
    trust = replace(trust, hazard=hazard, risk=risk, protection_m=_three(levels[:3]), protection_rad=_three(levels[3:]))
    status = "ok" if hazard <= model.hazard.limit else _WHY[model.hazard.strongest(evidence, known.usual)]
    return status, trust, honest


def verdict_of(view: Similarity | None, config: TrustConfig) -> Verdict:
    """What the predicted view says by itself."""
    if view is None or view.contrast < config.least_contrast or view.saturated > config.most_saturated:
        return "not_verifiable"
    return "verified" if view.score >= config.least_similarity else "contradicted"


def _is_inside(range_m: float, limits: tuple[float, float]) -> bool:
    return limits[0] / (2.0 * RANGE_SLACK) <= range_m <= RANGE_SLACK * limits[1]


def _three(levels: np.ndarray) -> tuple[float, float, float]:
    x, y, z = (float(level) for level in levels)
    return x, y, z


CheckedBy = Literal["everything", "nothing"]
"""Whether poses are judged by all evidence or returned as alignment leaves them."""
