"""Keypoints without covariances: how noisy are they?

Few points: the noise and the pose under which the points are likeliest, a point being either Gaussian about its
projection or anywhere in the image. Many points: the noise that the residuals show.
"""

import numpy as np

from proxnav.pose.solve.config import PoseConfig
from proxnav.pose.solve.consensus import Fit, agrees, fit_consensus
from proxnav.pose.solve.intake import Correspondences

_MAX_SIGMA_PX = 8.0  # most noise that is taken
_FEW = 11  # below this the median of the residuals says little: up to a third of the points may be wrong
_LARGEST_NOISE_SHARE = 0.05  # of the spread of the points in the image: more would make any cloud of points agree
_MEDIAN_D2 = 2.0 * np.log(2.0)  # median of chi-square with 2 degrees of freedom
_WORTH_A_REFIT = 1.2
_REFITS = 3


def fit_at_unknown_noise(data: Correspondences, config: PoseConfig) -> Fit | None:
    """The consensus at the noise that suits the points best, `config.sigma_px` at least; None without consensus."""
    ladder = _ladder(data, config)
    return _likeliest(ladder, data, config) if len(data.X) < _FEW else _measured(ladder, data, config)


def _likeliest(ladder: list[float], data: Correspondences, config: PoseConfig) -> Fit | None:
    """Tries larger and larger noise while it can still be likelier than the best so far."""
    best, least = None, np.inf
    for scale in ladder:
        if len(data.X) * _spread_cost(scale, config) >= least:
            break
        fit = fit_consensus(data, scale, config)
        if fit is not None and agrees(fit, data, config):
            cost = _surprise(fit, data, scale, config)
            best, least = (fit, cost) if cost < least else (best, least)
    return best


def _measured(ladder: list[float], data: Correspondences, config: PoseConfig) -> Fit | None:
    """The smallest noise of the ladder at which the points agree, then the noise that the residuals show."""
    for scale in ladder:
        fit = fit_consensus(data, scale, config)
        if fit is not None and agrees(fit, data, config):
            return _refitted(fit, scale, ladder[-1], data, config)
    return None


def _refitted(fit: Fit, scale: float, largest: float, data: Correspondences, config: PoseConfig) -> Fit:
    n = len(data.X)
    for _ in range(_REFITS):
        shown = scale * float(np.sqrt(np.median(fit.d2(data)) / _MEDIAN_D2 * n / (n - 3)))
        if min(shown, largest) <= _WORTH_A_REFIT * scale:
            break
        scale = min(shown, largest)
        refit = fit_consensus(data, scale, config)
        if refit is None or not agrees(refit, data, config):
            break
        fit = refit
    return fit


def _ladder(data: Correspondences, config: PoseConfig) -> list[float]:
    """Multiples of `config.sigma_px`: 1, 2, 4 ..."""
    largest = _MAX_SIGMA_PX / config.sigma_px
    spread_px = float(np.sqrt(data.pixels.var(axis=0).sum()))
    sensible = _LARGEST_NOISE_SHARE * spread_px / config.sigma_px
    scales = [1.0]
    while 2.0 * scales[-1] <= min(largest, sensible):
        scales.append(2.0 * scales[-1])
    return scales


def _surprise(fit: Fit, data: Correspondences, scale: float, config: PoseConfig) -> float:
    """-2 log likelihood: inliers Gaussian, the others uniform over the image."""
    count = int(np.count_nonzero(fit.use))
    outlier = 2.0 * np.log(data.image_px2)
    return float(fit.d2(data)[fit.use].sum()) + count * _spread_cost(scale, config) + (len(data.X) - count) * outlier


def _spread_cost(scale: float, config: PoseConfig) -> float:
    """-2 log likelihood of one inlier with no error."""
    return 2.0 * float(np.log(2.0 * np.pi * (scale * config.sigma_px) ** 2))
