"""What the alignment assumes about images and keypoint poses."""

from dataclasses import dataclass

USUAL_DOUBT = 0.005
"""1 - median keypoint score of an ordinary frame."""
_LEAST_DOUBT = 0.0005


@dataclass(frozen=True)
class AlignConfig:
    """Knobs of `align`; the defaults were chosen on validation images (docs/alignment.md)."""

    rough_side: int = 224
    """Pixels of the square in which starts are compared and roughly settled."""
    fine_side: int = 448
    """The most pixels of the square in which the pose is finally settled."""
    region_side: int = 80
    """Pixels of the square in which regions are compared."""
    margin: float = 1.15
    """Side of the square over the longer side of the target's box."""
    starts: int = 3
    """Axes of the keypoint pose's covariance along which other starts are tried; 0 tries the pose alone."""
    spread: tuple[float, ...] = (-3.5, 3.5)
    """Standard deviations along each axis."""
    settled: int = 2
    """Starts that are settled roughly."""
    finished: int = 2
    """Poses that are settled finely."""
    prior_rough: float = 5.0
    """Weight of the keypoint pose against points of the outline, which err together, in the rough steps."""
    prior_fine: float = 1.0
    """The same in the fine steps."""
    region_weight: float = 0.3
    """Of -log(unexplained share) in the evidence; the share of the outline on edges weighs 1."""
    prior_weight: float = 0.001
    """Of the squared Mahalanobis distance from the keypoint pose in the evidence."""
    prior_most: float = 60.0
    """Most of that distance that counts: keypoint poses have a tail."""
    outlier: float = 0.3
    """Weight of 'no edge here' against an edge of three times the least strength at offset 0."""
    temperature: float = 0.05
    """Evidence by which a pose must be better to count e times as much in the covariance."""
    covariance_scale: float = 16.0
    """Of the outline's own covariance: its points err together. Calibrated on validation images."""
    doubt_power: float = 0.0
    """Power of the keypoints' doubt by which that covariance is multiplied as well; 0 leaves doubt aside."""
    least_edge_share: float = 0.0
    """Share of the outline on edges below which the image contradicts the pose: it is refused."""

    def widening(self, doubt: float) -> float:
        """Factor on the outline's covariance for a doubt in [0, 1]; 1 at `USUAL_DOUBT`."""
        return ((doubt + _LEAST_DOUBT) / (USUAL_DOUBT + _LEAST_DOUBT)) ** self.doubt_power
