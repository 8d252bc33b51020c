"""Evidence to the probability of a hazardous pose: a logistic model of few parameters, fitted on drawn frames."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from proxnav.geometry.types import Flags
from proxnav.pose.trust.evidence import Doubts, Evidence

_EXPECTED = np.array([0.7, 0.7, 0.3, 0.1, 0.2, 3.0, 0.2])
"""Weights before any frame is drawn, in the order of `Doubts`: what 630 ray-cast poses of release 0.1 had said."""
_UNCERTAIN = 1.0
"""Standard deviation of each weight about that."""
KEPT = 0.95
"""Share of the good poses, of all conditions in equal parts, that stays accepted whatever the risk."""
CERTAIN = 1e-6


@dataclass(frozen=True, slots=True)
class HazardModel:
    """log odds of hazard = constant + sum of weight times doubt; no weight is negative, so doubt never helps."""

    constant: float
    scores: float
    edges: float
    turn: float
    shift: float
    residuals: float
    view: float
    saturated: float
    limit: float
    """Probability above which a pose is refused."""
    expected_risk: float
    """Share of hazardous poses among the accepted ones that is expected at that limit."""

    @property
    def weights(self) -> Float[np.ndarray, "doubts=7"]:
        """The weights in the order of `Doubts`."""
        return np.array([getattr(self, name) for name in Doubts._fields])

    def probability(self, evidence: Evidence) -> float:
        """Probability that a pose with this evidence is hazardous."""
        return float(self.probabilities(np.array([evidence.doubts()]))[0])

    def probabilities(self, doubts: Float[np.ndarray, "n doubts=7"]) -> Float[np.ndarray, "n"]:
        """Probabilities of many poses."""
        odds = np.clip(self.constant + doubts @ self.weights, -30.0, 30.0)
        return np.clip(1.0 / (1.0 + np.exp(-odds)), CERTAIN, 1.0 - CERTAIN)

    def strongest(self, evidence: Evidence, usual: Doubts) -> str:
        """The doubt that adds most to the odds beyond what a usual good pose has."""
        beyond = self.weights * (np.array(evidence.doubts()) - np.array(usual))
        return Doubts._fields[int(np.argmax(beyond))]


def usual_doubts(doubts: Float[np.ndarray, "n doubts=7"]) -> Doubts:
    """Medians of the doubts of good poses."""
    return Doubts(*(round(float(value), 3) for value in np.median(doubts, axis=0)))


def fitted_hazard(doubts: Float[np.ndarray, "n doubts=7"], hazardous: Flags, risk: float) -> HazardModel:
    """The likeliest model given poses and what was expected.

    Its limit keeps the expected share of hazard at `risk`, but gives up no more good poses than `KEPT` allows: few
    frames cannot promise a small risk, and `expected_risk` says what they do promise. Evidence that is the same in all
    poses gets no weight.
    """
    varies = doubts.std(axis=0) > 1e-9
    x, y, expected = doubts[:, varies], hazardous.astype(np.float64), _EXPECTED[varies]
    middle = x.mean(axis=0)

    def loss(v: Float[np.ndarray, "k"]) -> float:
        odds = v[0] + (x - middle) @ v[1:]
        away = (v[1:] - expected) / _UNCERTAIN
        return float(np.sum(np.logaddexp(0.0, odds) - y * odds) + 0.5 * away @ away)

    bounds = [(None, None)] + [(0.0, None)] * len(expected)
    found = minimize(loss, np.r_[-2.0, expected], method="L-BFGS-B", bounds=bounds).x
    weights = np.zeros(doubts.shape[1])
    weights[varies] = found[1:]
    numbers = [round(float(value), 4) for value in (found[0] - found[1:] @ middle, *weights)]
    p = HazardModel(*numbers, limit=1.0, expected_risk=1.0).probabilities(doubts)
    limit = max(_limit(p, risk), float(np.quantile(p[~hazardous], KEPT)))
    return HazardModel(*numbers, limit=round(limit, 6), expected_risk=round(float(p[p <= limit].mean()), 6))


def _limit(p: Float[np.ndarray, "n"], risk: float) -> float:
    """Largest limit at which the expected share of hazardous poses among the accepted ones is at most `risk`."""
    ordered = np.sort(p)
    share = np.cumsum(ordered) / np.arange(1, len(p) + 1)
    accepted = np.flatnonzero(share <= risk)
    return float(ordered[accepted[-1]]) if accepted.size else float(ordered[0])
