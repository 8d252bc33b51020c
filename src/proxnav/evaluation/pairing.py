"""Estimates and truth by file name, put side by side."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.errors import InputError
from proxnav.evaluation.errors import PoseErrors, pose_errors
from proxnav.geometry import Pose


@dataclass(frozen=True, slots=True, eq=False)
class Frame:
    """One image of the truth: its pose, and the estimate's errors where there is an estimate."""

    filename: str
    T_true: Pose
    status: str
    """The estimate's status; `missing` where the estimates do not know the image."""
    T_est: Pose | None = None
    errors: PoseErrors | None = None
    covariance: np.ndarray | None = None
    """(6, 6) that the estimate claims."""

    @property
    def range_m(self) -> float:
        """True range."""
        return float(np.linalg.norm(self.T_true.t_m))


def pair(estimates: Mapping[str, PoseRecord], truth: Mapping[str, PoseRecord]) -> tuple[Frame, ...]:
    """One Frame per image of the truth, in its order. InputError for estimates of images that the truth lacks."""
    extra = [name for name in estimates if name not in truth]
    if extra:
        raise InputError(
            f"{len(extra)} of {len(estimates)} estimates, first '{extra[0]}', have no truth; "
            "the truth must cover every estimated image, check that both files are of the same set"
        )
    if not truth:
        raise InputError("the truth holds no poses; give a file with at least one")
    return tuple(_frame(record, estimates.get(name)) for name, record in truth.items())


def errors_of(frames: tuple[Frame, ...]) -> list[PoseErrors]:
    """Errors of the frames that have a pose."""
    return [frame.errors for frame in frames if frame.errors is not None]


def _frame(truth: PoseRecord, estimate: PoseRecord | None) -> Frame:
    if truth.T_cam_target is None:
        raise InputError(f"the truth has no pose for '{truth.filename}'; remove the image or give its pose")
    if estimate is None:
        return Frame(truth.filename, truth.T_cam_target, "missing")
    T_est = estimate.T_cam_target
    if T_est is None:
        return Frame(truth.filename, truth.T_cam_target, estimate.status)
    errors = pose_errors(T_est, truth.T_cam_target)
    return Frame(truth.filename, truth.T_cam_target, estimate.status, T_est, errors, estimate.covariance)
