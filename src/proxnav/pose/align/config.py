"""What is calibrated about alignments; `model.json` carries it with the keypoints that it was calibrated for."""

from dataclasses import dataclass

USUAL_DOUBT = 0.005
"""1 - median keypoint score of an ordinary frame."""
_LEAST_DOUBT = 0.0005


@dataclass(frozen=True)
class AlignConfig:
    """How far the covariance of an alignment is to be believed, and when the alignment is refused."""

    covariance_scale: float = 16.0
    """Factor on the covariance of the outline alone, whose points err together."""
    doubt_power: float = 0.0
    """Power of the keypoints' doubt by which that covariance is multiplied as well; 0 leaves doubt aside."""
    least_edge_share: float = 0.0
    """Share of the outline on edges below which the image contradicts the pose: it is refused."""

    def widening(self, doubt: float) -> float:
        """Factor on the outline's covariance for a doubt in [0, 1]; 1 at `USUAL_DOUBT`."""
        return ((doubt + _LEAST_DOUBT) / (USUAL_DOUBT + _LEAST_DOUBT)) ** self.doubt_power
