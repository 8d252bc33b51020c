"""Estimates and truth by file name, put side by side."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float
from scipy.stats import chi2

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError
from proxnav.geometry import Pose
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference
from proxnav.geometry.pose_errors import PoseErrors, pose_errors
from proxnav.records.estimates import Trust

HAZARDOUS_RAD, HAZARDOUS_TN = np.radians(5.0), 0.05
HAZARDOUS_NEES = chi2.ppf(0.9999, 6)


@dataclass(frozen=True, slots=True, eq=False)
class PairedFrame:
    """One image of the truth: its pose, and the estimate's errors where there is an estimate."""

    filename: str
    T_true: Pose
    status: str
    """The estimate's status; `missing` where the estimates do not know the image."""
    T_est: Pose | None = None
    errors: PoseErrors | None = None
    covariance: Float[np.ndarray, "6 6"] | None = None
    """Covariance of (dt [m], dr [rad]) that the estimate claims, camera axes."""
    trust: Trust | None = None
    """Evidence about the estimate, where its file has protection levels."""

    @property
    def range_m(self) -> float:
        """True range."""
        return float(np.linalg.norm(self.T_true.t_m))

    @property
    def difference(self) -> Float[np.ndarray, "6"]:
        """True less estimated (dt [m], dr [rad]), camera axes; NaN without an estimate."""
        return np.full(6, np.nan) if self.T_est is None else difference(self.T_est, self.T_true)

    @property
    def protection(self) -> Float[np.ndarray, "6"]:
        """Protection levels of (dt [m], dr [rad]), camera axes; NaN where there are none."""
        return np.full(6, np.nan) if self.trust is None else self.trust.protection

    @property
    def normalised(self) -> Float[np.ndarray, "6"]:
        """Differences over their claimed standard deviations; NaN where no covariance is claimed."""
        if self.covariance is None:
            return np.full(6, np.nan)
        return self.difference / np.sqrt(np.maximum(np.diagonal(self.covariance), 1e-300))

    @property
    def nees(self) -> float:
        """Squared Mahalanobis length of the difference under the claimed covariance; infinite where that is not
        positive, NaN where none is claimed.
        """
        if self.T_est is None or self.covariance is None:
            return float("nan")
        return float(squared_mahalanobis(self.difference, self.covariance))

    @property
    def is_hazardous(self) -> bool:
        """Whether a filter that takes the pose as it claims to be is misled: off by more than 5 deg or 0.05 of the
        range, or outside the ellipsoid that holds all but one in ten thousand of honest errors.
        """
        if self.errors is None:
            return False
        large = self.errors.e_r_rad > HAZARDOUS_RAD or self.errors.e_tn > HAZARDOUS_TN
        return bool(large or self.nees > HAZARDOUS_NEES)


def pair(estimates: Mapping[str, PoseRecord], truth: Mapping[str, PoseRecord]) -> tuple[PairedFrame, ...]:
    """One frame per image of the truth, in its order. InputError for estimates of images that the truth lacks."""
    extra = [name for name in estimates if name not in truth]
    if extra:
        raise InputError(
            f"{len(extra)} of {len(estimates)} estimates, first '{extra[0]}', have no truth; "
            "the truth must cover every estimated image, check that both files are of the same set"
        )
    if not truth:
        raise InputError("the truth holds no poses; give a file with at least one")
    return tuple(_paired(record, estimates.get(name)) for name, record in truth.items())


def errors_of(frames: Sequence[PairedFrame]) -> list[PoseErrors]:
    """Errors of the frames that have a pose."""
    return [frame.errors for frame in frames if frame.errors is not None]


def from_best_to_worst(frames: Sequence[PairedFrame]) -> list[int]:
    """Places of the frames in order of E_C; those without a pose last."""
    errors = [np.inf if frame.errors is None else frame.errors.e_c for frame in frames]
    return np.argsort(errors, kind="stable").tolist()


def _paired(truth: PoseRecord, estimate: PoseRecord | None) -> PairedFrame:
    name, T_true = truth.filename, truth.T_cam_target
    if T_true is None or not T_true.t_m.any():
        raise InputError(f"the truth has no pose for '{name}' at a range above 0 m; remove the image or give one")
    if estimate is None or estimate.T_cam_target is None:
        return PairedFrame(name, T_true, "missing" if estimate is None else estimate.status)
    T_est = estimate.T_cam_target
    return PairedFrame(
        name, T_true, estimate.status, T_est, pose_errors(T_est, T_true), estimate.covariance,
        estimate.trust,
    )  # fmt: skip
