"""Protection levels: per axis, the error that is exceeded with at most the stated risk, faults included.

Factors on the claimed standard deviation, one for each class of doubt and kind of axis, are quantiles over drawn frames
whose truth is known (conformal prediction, grouped by class so that hard frames are covered too). Where frames are
fewer than the risk asks for, the tail is taken as exponential above its 90 % quantile.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from proxnav.geometry.types import PoseCovariance

KINDS = ("lateral", "depth", "turn")
"""Kinds of axes: across the line of sight, along it, rotation; their indices in (dt, dr) are `AXES`."""
AXES = ((0, 1), (2,), (3, 4, 5))
_TAIL = 0.9
_LEAST_CLASS = 30
"""Poses that a class of doubt needs to have factors of its own."""


@dataclass(frozen=True, slots=True)
class ProtectionFactors:
    """Factors on the standard deviations of a pose, those of its widened covariance, by its probability of hazard."""

    risk: float
    edges: tuple[float, ...]
    """Probabilities of hazard at which the next class begins; one fewer than there are classes."""
    factors: tuple[tuple[float, float, float], ...]
    """For each class: lateral, depth, turn."""

    def levels(self, covariance: PoseCovariance, hazard: float) -> Float[np.ndarray, "6"]:
        """Protection levels of (dt [m], dr [rad]) in the camera frame."""
        own = self.factors[self._class(hazard)]
        out = np.sqrt(np.diagonal(covariance)).copy()
        for axes, factor in zip(AXES, own, strict=True):
            out[list(axes)] *= factor
        return out

    def _class(self, hazard: float) -> int:
        return int(np.searchsorted(self.edges, hazard, side="right"))


def calibrated_protection(
    errors: Float[np.ndarray, "n 6"],
    covariances: Float[np.ndarray, "n 6 6"],
    hazards: Float[np.ndarray, "n"],
    risk: float,
    classes: int = 4,
) -> ProtectionFactors:
    """Factors that the errors of drawn frames ask for, in classes of equally many poses."""
    ratios = np.abs(errors) / np.sqrt(np.einsum("nii->ni", covariances))
    count = int(np.clip(len(ratios) // _LEAST_CLASS, 1, classes))
    edges = tuple(round(float(q), 7) for q in np.quantile(hazards, np.arange(1, count) / count))
    own = np.searchsorted(edges, hazards, side="right")
    factors, least = [], np.ones(3)
    for k in range(count):
        least = np.maximum(least, [_factor(ratios[own == k][:, list(axes)].max(axis=1), risk) for axes in AXES])
        factors.append(tuple(round(float(value), 3) for value in least))  # more doubt never protects less
    return ProtectionFactors(risk, edges, tuple(factors))


def _factor(ratios: Float[np.ndarray, "n"], risk: float) -> float:
    """The (1 - risk) quantile with finite-sample validity where the sample reaches it, else by the tail."""
    n = len(ratios)
    rank = int(np.ceil((n + 1) * (1.0 - risk)))
    if rank <= n:
        return float(np.sort(ratios)[rank - 1])
    start = float(np.quantile(ratios, _TAIL))
    excess = float(np.mean(ratios[ratios >= start] - start))
    return max(start + excess * float(np.log((1.0 - _TAIL) / risk)), float(ratios.max()))
