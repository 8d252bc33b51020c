"""What speaks for a pose and against it, as numbers that grow with doubt."""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from proxnav.geometry import Pose
from proxnav.geometry.perturbation import ROTATION, TRANSLATION, difference
from proxnav.pose.trust.local_correlation import Similarity

_TURN_FLOOR_RAD = np.radians(0.2)
_SHIFT_FLOOR = 0.002
_LEAST_P = 1e-12


class Doubts(NamedTuple):
    """The evidence on scales on which a step of 1 is a clear step; larger is worse."""

    scores: float
    """Log of the doubt of the surest three quarters of the keypoints."""
    edges: float
    """Share of the outline that lies on no edge, in steps of 0.2."""
    turn: float
    """Log of the angle between the keypoints' pose and the aligned one."""
    shift: float
    """Log of their distance over the range."""
    residuals: float
    """Decades of the keypoints' p-value, in steps of 4."""
    view: float
    """Dissimilarity of picture and predicted view, in steps of 0.15; 0 where none could be compared."""
    saturated: float
    """Share of the craft's pixels at the end of the picture's scale, in steps of 0.3."""


@dataclass(frozen=True, slots=True)
class Evidence:
    """Evidence about one pose, as it is measured."""

    lower_quartile_score: float
    """Score that three quarters of the keypoints exceed."""
    edge_share: float
    """Share of the outline that lies on edges of the picture; 0 where the pose could not be aligned."""
    turn_rad: float
    """Angle between the keypoints' pose and the aligned one."""
    shift_share: float
    """Distance between the two, over the range."""
    p_value: float
    """p-value of the residuals of all keypoints."""
    view: Similarity | None = None
    """Likeness to the view that is predicted under the Sun that was told; None where none was."""
    saturated: float = 0.0
    """Share of the pixels inside the craft's hull at the end of the picture's scale."""

    @staticmethod
    def of(
        scores: float, p_value: float, keypoint_pose: Pose, aligned: Pose | None, edge_share: float, saturated: float
    ) -> "Evidence":
        """From the lower quartile of the scores, the keypoints' pose and the aligned one."""
        if aligned is None:
            return Evidence(scores, 0.0, 0.0, 0.0, p_value, saturated=saturated)
        d = difference(keypoint_pose, aligned)
        distance = float(np.linalg.norm(d[TRANSLATION]) / np.linalg.norm(aligned.t_m))
        return Evidence(scores, edge_share, float(np.linalg.norm(d[ROTATION])), distance, p_value, saturated=saturated)

    def seen(self, view: Similarity | None) -> "Evidence":
        """The same with a predicted view that was compared."""
        return replace(self, view=view)

    def doubts(self) -> Doubts:
        """The evidence as doubts."""
        return Doubts(
            float(np.log(1.0 - min(self.lower_quartile_score, 1.0) + 1e-3)),
            (1.0 - self.edge_share) / 0.2,
            float(np.log(self.turn_rad + _TURN_FLOOR_RAD)),
            float(np.log(self.shift_share + _SHIFT_FLOOR)),
            -float(np.log10(max(self.p_value, _LEAST_P))) / 4.0,
            0.0 if self.view is None else (1.0 - self.view.score) / 0.15,
            self.saturated / 0.3,
        )


def doubt_rows(evidence: "list[Evidence]") -> Float[np.ndarray, "n doubts=7"]:
    """The doubts of many poses, one row each."""
    return np.array([one.doubts() for one in evidence], dtype=np.float64).reshape(-1, len(Doubts._fields))
