"""Whether the claimed covariances are honest, and how near the errors come to the Cramer-Rao bound."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from proxnav.evaluation.pairing import PairedFrame
from proxnav.geometry.mahalanobis import squared_mahalanobis

_DEGREES_OF_FREEDOM = 6
THREE_SIGMA_NEES = chi2.ppf(0.9973, _DEGREES_OF_FREEDOM)
"""Squared error whose ellipsoid holds as much probability as 3 sigma of one number."""


@dataclass(frozen=True, slots=True)
class Consistency:
    """Normalised squared errors (NEES) of poses that claim a covariance."""

    poses: int
    mean_nees: float
    """6 when the covariances are honest, more when they are too small."""
    nees_interval: tuple[float, float]
    """95 % interval of the mean NEES of honest covariances, that many poses."""
    beyond_3_sigma: float
    """Share of poses outside the ellipsoid that holds 99.73 % of honest errors."""
    axis_beyond_3_sigma: float
    """Share of the single errors (six a pose) beyond three of their claimed standard deviations; 0.27 % if honest."""

    @property
    def is_consistent(self) -> bool:
        """Whether the mean lies in the interval."""
        low, high = self.nees_interval
        return low <= self.mean_nees <= high


@dataclass(frozen=True, slots=True)
class Efficiency:
    """Errors in one range bin against the bound: root mean squares and their ratios, 1 at best."""

    poses: int
    rms_t_m: float
    bound_t_m: float
    rms_r_rad: float
    bound_r_rad: float
    median_t: float
    """Median over the poses of position error / bound of the same frame; below 1 at best, but blind to the tail."""
    median_r: float
    """The same of attitude."""

    @property
    def translation(self) -> float:
        """RMS position error over its bound."""
        return self.rms_t_m / self.bound_t_m

    @property
    def rotation(self) -> float:
        """RMS attitude error over its bound."""
        return self.rms_r_rad / self.bound_r_rad


def consistency(frames: Sequence[PairedFrame]) -> Consistency | None:
    """Honesty of the claims of all frames that have a pose and a covariance; None when there is none."""
    errors, covariances = _claims(frames)
    if len(errors) == 0:
        return None
    values = squared_mahalanobis(errors, covariances)
    sigmas = np.sqrt(np.diagonal(covariances, axis1=1, axis2=2))
    m = len(values)
    low, high = chi2.ppf([0.025, 0.975], _DEGREES_OF_FREEDOM * m) / m
    return Consistency(
        poses=m,
        mean_nees=float(values.mean()),
        nees_interval=(float(low), float(high)),
        beyond_3_sigma=float((values > THREE_SIGMA_NEES).mean()),
        axis_beyond_3_sigma=float((np.abs(errors) > 3.0 * sigmas).mean()),
    )


def efficiency_by_range(
    frames: Sequence[PairedFrame], bounds: Mapping[str, Float[np.ndarray, "6 6"]], edges_m: Sequence[float]
) -> dict[tuple[float, float], Efficiency]:
    """RMS errors over the Cramer-Rao bound per range bin; `bounds` are by file name."""
    known = [frame for frame in frames if frame.T_est is not None and frame.filename in bounds]
    found = {}
    for near, far in pairwise(edges_m):
        inside = [frame for frame in known if near <= frame.range_m < far]
        if inside:
            found[(float(near), float(far))] = _efficiency(inside, bounds)
    return found


def _efficiency(frames: Sequence[PairedFrame], bounds: Mapping[str, Float[np.ndarray, "6 6"]]) -> Efficiency:
    squared = np.array([frame.difference**2 for frame in frames]).reshape(-1, 2, 3).sum(axis=2)
    variances = np.array([np.diagonal(bounds[frame.filename]) for frame in frames]).reshape(-1, 2, 3).sum(axis=2)
    rms, bound = np.sqrt(squared.mean(axis=0)), np.sqrt(variances.mean(axis=0))
    median = np.median(np.sqrt(squared / variances), axis=0)
    return Efficiency(len(frames), *(float(x) for x in (rms[0], bound[0], rms[1], bound[1], median[0], median[1])))


def _claims(frames: Sequence[PairedFrame]) -> tuple[Float[np.ndarray, "m 6"], Float[np.ndarray, "m 6 6"]]:
    claimed = [frame for frame in frames if frame.T_est is not None and frame.covariance is not None]
    errors = np.array([frame.difference for frame in claimed]).reshape(-1, 6)
    covariances = np.array([frame.covariance for frame in claimed]).reshape(-1, 6, 6)
    return errors, covariances
