"""What the detector and the pose solver say: keypoints and poses, each with its covariance and its status."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float

from proxnav.geometry import Pose
from proxnav.geometry.arrays import frozen
from proxnav.geometry.types import Box

DetectionStatus = Literal["ok", "no_target", "bad_image"]
PoseStatus = Literal[
    "ok", "too_few_points", "no_consensus", "behind_camera", "mirrored_points", "other_pixels", "no_target",
    "bad_image", "unlike_render", "other_craft", "ambiguous", "outside_mission", "camera_suspect", "lost",
]  # fmt: skip
"""Whether there is a pose, or why there is none: `REASONS` says it in words."""
REASONS: dict[str, str] = {
    "too_few_points": "fewer than four keypoints at distinct places",
    "no_consensus": "the keypoints agree on no pose, or on two",
    "behind_camera": "the keypoints fit a craft behind the camera: is the sign of an axis wrong?",
    "mirrored_points": "the keypoints agree as a mirror image only: are x and y exchanged, does an axis count from the "
    "other side, or are left and right points named the other way round?",
    "other_pixels": "the keypoints are no pixels of this camera: shares of the image in [0, 1], or pixels of a crop? "
    "Scale and shift them to the full image first",
    "no_target": "the picture does not show the target",
    "bad_image": "the picture cannot be read or is blank",
    "unlike_render": "the picture does not show what the pose predicts",
    "other_craft": "the picture shows another craft, or the target changed",
    "ambiguous": "another pose explains the picture nearly as well",
    "outside_mission": "the pose lies outside of what the model was made for",
    "lost": "the outline is not where the target's motion leads: the tracker lost it, or began with a wrong pose",
    "camera_suspect": "the poses of a sequence say that the camera is not as its calibration",
}
"""One sentence for each status but ok."""
Verdict = Literal["verified", "contradicted", "not_verifiable"]


NAN_AXES: tuple[float, float, float] = (float("nan"), float("nan"), float("nan"))


@dataclass(frozen=True, slots=True)
class Trust:
    """Evidence about one pose."""

    verdict: Verdict
    """What the predicted view says: verified, contradicted, or not_verifiable where no Sun was told, little contrast is
    predicted or the picture is damaged."""
    similarity: float
    """Local correlation with the view that is predicted at the pose, -1 to 1; NaN where none was compared."""
    hazard: float = float("nan")
    """Calibrated probability that the pose is hazardous; NaN from models without a calibration."""
    p_value: float = float("nan")
    """As in `PoseResult`: of the residuals of all keypoints."""
    protection_m: tuple[float, float, float] = NAN_AXES
    """Errors along x, y, z of the camera frame [m] that are exceeded with the stated risk at most."""
    protection_rad: tuple[float, float, float] = NAN_AXES
    """The same for turns about x, y, z of the camera frame [rad]."""
    risk: float = float("nan")
    """Risk that the protection levels state."""

    @property
    def protection(self) -> Float[np.ndarray, "6"]:
        """Protection levels of (dt [m], dr [rad]), camera axes."""
        return np.array([*self.protection_m, *self.protection_rad])


@dataclass(frozen=True, slots=True, eq=False)
class Keypoints:
    """Keypoints of one image in the order of the target's keypoint list; a point not found is NaN with score 0."""

    status: DetectionStatus
    pixels: Float[np.ndarray, "n_keypoints 2"]
    """Keypoints [px], corner origin, full image."""
    covariances_px2: Float[np.ndarray, "n_keypoints 2 2"]
    scores: Float[np.ndarray, "n_keypoints"]
    """Confidence of each keypoint, 0 to 1."""
    box_xyxy: Box
    """Box of the target [px]; NaN when there is none."""
    upright: "Keypoints | None" = None
    """What the same network reads in the crop as it stands, where it is nearly as sure of that and not sure which."""

    def __post_init__(self) -> None:
        n = len(self.pixels)
        object.__setattr__(self, "pixels", frozen(self.pixels, (n, 2), "pixels"))
        object.__setattr__(self, "covariances_px2", frozen(self.covariances_px2, (n, 2, 2), "covariances_px2"))
        object.__setattr__(self, "scores", frozen(self.scores, (n,), "scores"))
        object.__setattr__(self, "box_xyxy", frozen(self.box_xyxy, (4,), "box_xyxy"))

    @property
    def median_score(self) -> float:
        """Median score of the keypoints that were found; 0 when there are none."""
        found = self.scores[self.scores > 0.0]
        return float(np.median(found)) if found.size else 0.0

    @property
    def lower_quartile_score(self) -> float:
        """Score that three quarters of all keypoints exceed, those not found counting as 0."""
        return float(np.percentile(self.scores, 25.0))

    @staticmethod
    def none(status: DetectionStatus, n_keypoints: int) -> "Keypoints":
        """No keypoints, and why."""
        nan = np.nan
        return Keypoints(
            status,
            np.full((n_keypoints, 2), nan),
            np.full((n_keypoints, 2, 2), nan),
            np.zeros(n_keypoints),
            np.full(4, nan),
        )


NO_MOVES = frozen(np.zeros((6, 3)), (6, 3), "calibration_moves")
"""What the errors of a camera that is taken as exact do to a pose."""


@dataclass(frozen=True, slots=True, eq=False)
class PoseResult:
    """A pose with its covariance, or the reason why there is none."""

    status: PoseStatus
    T_cam_target: Pose | None
    covariance: Float[np.ndarray, "6 6"] | None
    """Covariance of (dt [m], dr [rad]) in the camera frame: t_true = t + dt, R_true = exp(dr) R."""
    inliers: Bool[np.ndarray, "n_points"]
    """Which of the given points the pose rests on."""
    reprojection_rms_px: float = float("nan")
    """Root mean square reprojection error over the inliers [px]."""
    calibration_moves: Float[np.ndarray, "6 calibration=3"] = field(default_factory=lambda: NO_MOVES)
    """(dt, dr) by one standard deviation of each error of the camera's calibration: focal length, principal point along
    x and y. The covariance holds them; they are the same in every image."""
    p_value: float = float("nan")
    """Chance that honest keypoints, occluded ones among them, leave residuals as large as all of these; NaN without a
    pose."""
    trust: Trust | None = None
    """Evidence about the pose; None where nothing was checked."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "inliers", frozen(self.inliers, (None,), "inliers", bool))
        if self.covariance is not None:
            object.__setattr__(self, "covariance", frozen(self.covariance, (6, 6), "covariance"))
        if self.calibration_moves is not NO_MOVES:
            moves = frozen(self.calibration_moves, (6, 3), "calibration_moves")
            object.__setattr__(self, "calibration_moves", moves)

    @staticmethod
    def failure(status: PoseStatus, n_points: int) -> "PoseResult":
        """No pose, and why."""
        return PoseResult(status, None, None, np.zeros(n_points, dtype=bool))
