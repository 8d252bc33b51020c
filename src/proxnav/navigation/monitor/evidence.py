"""Whether residuals are those of an honest pair of sensors: medians of blocks, then chi-square."""

from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float
from scipy.stats import chi2

BLOCKS = 6
"""Pieces into which a window is cut; the median of each outvotes single wrong readings."""
_DROPPED = 3
"""One block of so many, the worst, is left out: there wrong readings were in the majority."""
_MEDIAN = 1.57
"""Variance of a median over that of a mean."""
_REFUTED, _FITS = 1e-9, 1e-3
"""Tail probabilities: what an honest pair exceeds so seldom is refuted; what fits stays below the other."""
_SLACK = 1.5
"""On both, for noise that is not normal."""
CLEARLY = 50.0
"""Difference of chi-squares by which one hypothesis beats another."""


class Noise(NamedTuple):
    """Variances of residuals, axis by axis."""

    white: Float[np.ndarray, "n 3"]
    """New in each sample."""
    constant: Float[np.ndarray, "3"]
    """Variance of an error that lasts through the window."""
    drift: float = 0.0
    """New in each block, but the same in all its samples."""


class Fit(NamedTuple):
    """How well each hypothesis does."""

    chi2: Float[np.ndarray, "n_hypotheses"]
    dof: int
    constant: Float[np.ndarray, "n_hypotheses"]
    """The part of it, of 3 degrees of freedom, that an error lasting through the window makes."""

    def refuted(self, k: int = 0) -> bool:
        """Whether honest residuals would never look so."""
        lasting = self.constant[k] > _SLACK * _bound(_REFUTED, 3)
        return bool(lasting or self.chi2[k] > _SLACK * _bound(_REFUTED, self.dof))

    def fits(self, k: int) -> bool:
        """Whether residuals look as honest ones do."""
        return bool(self.chi2[k] < _SLACK * _bound(_FITS, self.dof))


@cache
def _bound(tail: float, dof: int) -> float:
    return float(chi2.isf(tail, dof))


def fit(t: Float[np.ndarray, "n"], residuals: Float[np.ndarray, "h n 3"], noise: Noise) -> Fit | None:
    """Chi-square of each hypothesis, a constant error of known size allowed for; None where samples are too few."""
    cells = _blocks(t)
    if len(cells) < BLOCKS // 2:
        return None
    e = np.stack([np.median(residuals[:, cell], axis=1) for cell in cells], axis=1)
    count = np.array([cell.sum() for cell in cells])[:, None]
    white = np.stack([noise.white[cell].mean(axis=0) for cell in cells])
    variance = white * np.where(count > 2, _MEDIAN, 1.0) / count + noise.drift
    kept = max(len(cells) - len(cells) // _DROPPED, 1)
    order = np.argsort((e * e / (variance + noise.constant)).sum(axis=2), axis=1)[:, :kept]
    e, w = np.take_along_axis(e, order[:, :, None], axis=1), 1.0 / variance[order]
    s = (e * w).sum(axis=1)
    total = (e * e * w).sum(axis=(1, 2)) - (s * s / (1.0 / noise.constant + w.sum(axis=1))).sum(axis=1)
    sum_w = w.sum(axis=1)
    constant = (np.square(s / sum_w) / (noise.constant + 1.0 / sum_w)).sum(axis=1)
    return Fit(total, kept * 3, constant)


def _blocks(t: Float[np.ndarray, "n"]) -> list[Bool[np.ndarray, "n"]]:
    """Which samples lie in each block that has some."""
    if len(t) < BLOCKS:
        return []
    edges = np.linspace(t[0], t[-1] + 1e-6, BLOCKS + 1)
    place = np.searchsorted(edges, t, side="right") - 1
    cells = [place == k for k in range(BLOCKS)]
    return [cell for cell in cells if cell.any()]
