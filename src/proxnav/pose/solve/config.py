"""What the pose solver assumes about keypoints and when it refuses."""

from dataclasses import dataclass
from typing import Literal

from proxnav.errors import InputError


@dataclass(frozen=True)
class PoseConfig:
    """Knobs of `estimate_pose`; the defaults suit 4 to some hundred keypoints of a trained detector."""

    sigma_px: float = 1.0
    """Keypoint noise per axis [px] where no covariances are given; the least that the covariance claims then."""
    max_sigma_px: float = 8.0
    """Where no covariances are given the noise may be taken larger than `sigma_px`, up to this [px]."""
    gate_sigma: float = 4.0
    """A keypoint is an inlier when its reprojection error is below this many standard deviations."""
    gate_floor_px: float = 0.5
    """Standard deviation [px] added to every keypoint's own in the gate, not in the weights."""
    min_inliers: int = 4
    """Fewest inliers at distinct places; four is the geometric minimum for one pose."""
    min_inlier_share: float = 0.5
    """Least share of the usable keypoints that must agree on the pose."""
    min_score: float = 0.0
    """Keypoints whose score is not above this are left out."""
    view_margin: float = 1.0
    """Keypoints further outside the image than this many image sizes are left out."""
    loss: Literal["squares", "huber", "cauchy"] = "huber"
    """Robust loss of the refinement, on top of the gate."""
    loss_sigma: float = 2.5
    """Standard deviations at which the robust loss leaves the square."""
    ambiguity: float = 4.0
    """Refuse when another pose fits nearly as well: least gap of the squared normalised errors (4: odds of 7 to 1)."""
    inflation: Literal["residual", "none"] = "residual"
    """`residual` widens the covariance when the residuals are larger than the keypoint covariances say."""
    enumerate_up_to: int = 10
    """Up to this many keypoints all three-point subsets are tried, beyond it subsets are drawn."""
    max_samples: int = 1000
    """Most subsets drawn."""
    confidence: float = 0.9999
    """Probability of having drawn one subset of inliers, at which drawing stops."""
    seed: int = 0
    """Of the draw; the same input always gives the same pose."""

    def __post_init__(self) -> None:
        for name in ("sigma_px", "max_sigma_px", "gate_sigma", "loss_sigma", "max_samples"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"pose configuration: {name} must be positive, found {getattr(self, name)}")
        if self.min_inliers < 4:
            raise InputError(f"pose configuration: min_inliers must be at least 4, found {self.min_inliers}")
        if not (0.0 <= self.min_inlier_share <= 1.0 and 0.0 < self.confidence < 1.0):
            raise InputError(
                "pose configuration: min_inlier_share must lie in [0, 1] and confidence in (0, 1), "
                f"found {self.min_inlier_share} and {self.confidence}"
            )
