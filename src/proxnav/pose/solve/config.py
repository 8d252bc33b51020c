"""What the pose solver assumes about keypoints and when it refuses."""

from dataclasses import dataclass
from typing import Literal

from proxnav.errors import InputError


@dataclass(frozen=True)
class PoseConfig:
    """Settings of `estimate_pose`; the defaults suit 4 to some hundred keypoints of a trained detector."""

    sigma_px: float = 1.0
    """Keypoint noise per axis [px] where no covariances are given; the least that the covariance claims then."""
    gate_sigma: float = 4.0
    """A keypoint is an inlier when its reprojection error is below this many standard deviations."""
    min_inliers: int = 4
    """Fewest inliers at distinct places; four is the geometric minimum for one pose."""
    min_inlier_share: float = 0.5
    """Least share of the usable keypoints that must agree on the pose."""
    min_score: float = 0.0
    """Keypoints whose score is not above this are left out."""
    loss: Literal["squares", "huber", "cauchy"] = "huber"
    """Robust loss of the refinement, on top of the gate; the last two leave the square at 2.5 standard deviations."""
    inflation: Literal["residual", "none"] = "residual"
    """`residual` widens the covariance when the residuals are larger than the keypoint covariances say."""

    def __post_init__(self) -> None:
        for name in ("sigma_px", "gate_sigma"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"pose configuration: {name} must be positive, found {getattr(self, name)}")
        if self.min_inliers < 4:
            raise InputError(f"pose configuration: min_inliers must be at least 4, found {self.min_inliers}")
        if not 0.0 <= self.min_inlier_share <= 1.0:
            raise InputError(f"pose configuration: min_inlier_share must lie in [0, 1], found {self.min_inlier_share}")
