"""How much wider than claimed a covariance must be to be honest, by the evidence about its pose.

The log of the factor is linear in the doubts: the likeliest law, given errors on drawn frames, of normal errors whose
covariance is the claimed one times that factor (a log-linear variance model: A. C. Harvey, "Estimating Regression
Models with Multiplicative Heteroscedasticity", Econometrica 44, 1976).
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.optimize import minimize

from proxnav.geometry.types import PoseCovariance
from proxnav.pose.trust.evidence import Doubts, Evidence

_DIMENSIONS = 6
_UNCERTAIN = 0.5
"""Standard deviation of each weight about 0 before any frame is drawn."""
_COUNTED = 0.98
"""Quantile of squared errors as which larger ones count: they are confusions, which no covariance should cover."""
_LEAST, _MOST = -1.5, 4.0
"""Logs of the least and the largest factor."""


@dataclass(frozen=True, slots=True)
class Widening:
    """log factor = constant + sum of weight times (doubt - usual doubt); no weight is negative."""

    constant: float
    weights: Doubts
    usual: Doubts

    def factor(self, evidence: Evidence) -> float:
        """Factor on the covariance of a pose with this evidence."""
        return float(self.factors(np.array([evidence.doubts()]))[0])

    def factors(self, doubts: Float[np.ndarray, "n doubts=7"]) -> Float[np.ndarray, "n"]:
        """Factors of many poses."""
        logs = self.constant + (doubts - np.array(self.usual)) @ np.array(self.weights)
        return np.exp(np.clip(logs, _LEAST, _MOST))

    def widened(self, covariance: PoseCovariance, evidence: Evidence) -> PoseCovariance:
        """The covariance that is honest for poses with this evidence."""
        return covariance * self.factor(evidence)


def fitted_widening(doubts: Float[np.ndarray, "n doubts=7"], nees: Float[np.ndarray, "n"], usual: Doubts) -> Widening:
    """The likeliest law for poses with these doubts and squared normalised errors (of 6, claimed covariances)."""
    x, squared = doubts - np.array(usual), np.minimum(nees, np.quantile(nees, _COUNTED))

    def loss(v: Float[np.ndarray, "k"]) -> float:
        logs = np.clip(v[0] + x @ v[1:], _LEAST, _MOST)
        likelihood = 0.5 * np.sum(_DIMENSIONS * logs + squared * np.exp(-logs))
        return float(likelihood + 0.5 * np.sum((v[1:] / _UNCERTAIN) ** 2))

    bounds = [(_LEAST, _MOST)] + [(0.0, None)] * x.shape[1]
    found = minimize(loss, np.r_[0.0, np.full(x.shape[1], 0.05)], method="L-BFGS-B", bounds=bounds).x
    constant, *weights = (round(float(value), 4) for value in found)
    return Widening(constant, Doubts(*weights), usual)
