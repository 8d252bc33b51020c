"""How the covariances that an estimator claims divide into lasting and new errors.

The simulated camera and the filter share them; `proxnav benchmark detector` measures the numbers.
"""

from dataclasses import dataclass

from proxnav.errors import InputError


@dataclass(frozen=True)
class KeypointErrorModel:
    """How the covariance that the detector claims of keypoints divides; the shares need not add up to 1.

    `proxnav benchmark detector` measures these numbers; docs/navigation.md says what they mean.
    """

    pose_share: float = 0.72
    """Lasts as an error of the whole pose: the network sees a target of the right shape in a wrong place."""
    point_share: float = 0.085
    """Lasts too, of each keypoint by itself."""
    white_share: float = 0.0046
    """New in every frame."""
    tau_s: float = 385.0
    """How long lasting errors last (first-order Gauss-Markov)."""

    def __post_init__(self) -> None:
        if min(self.pose_share, self.point_share) < 0.0 or not self.white_share > 0.0 or not self.tau_s > 0.0:
            raise InputError("camera: white_share and tau_s must be positive, the other shares at least 0")


@dataclass(frozen=True)
class PoseErrorModel:
    """The same of the poses that the estimator gives, laid onto the image's edges after the keypoints.

    Defaults: `aligned_poses` of benchmarks/results/detector/detector.json, which the same command measures.
    """

    lasting_share: float = 0.78
    white_share: float = 0.067
    tau_s: float = 235.0

    def __post_init__(self) -> None:
        if self.lasting_share < 0.0 or not self.white_share > 0.0 or not self.tau_s > 0.0:
            raise InputError("poses: white_share and tau_s must be positive, lasting_share at least 0")
