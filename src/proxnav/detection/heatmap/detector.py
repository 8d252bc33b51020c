"""Full frame in, keypoints with covariances out: find, crop, read, look again closer. Needs no torch."""

from dataclasses import dataclass

import numpy as np

from proxnav.datasets.records import Keypoints
from proxnav.detection.heatmap.crop import Crop, cut
from proxnav.detection.heatmap.patch import largest_patch
from proxnav.detection.images import grey_8_bit, is_blank
from proxnav.detection.sessions import Session
from proxnav.geometry.types import Box

_CELL = 4
"""Input pixels per cell of the finder's map."""


@dataclass(frozen=True)
class HeatmapDetector:
    """The two networks and how their answers are read."""

    find: Session
    read: Session
    n_keypoints: int
    finder_side: int = 256
    crop_side: int = 256
    margin: float = 1.3
    """Side of the crop over the longer side of the box."""
    looks: int = 2
    """Crops that are read; each after the first is centred on the keypoints of the one before."""
    min_score: float = 0.05
    """Keypoints whose peak holds less probability are reported as not found."""
    min_shown: float = 0.02
    """Share of the crop that must show the target."""
    spread_scale: float = 1.0
    """Factor on the standard deviations, from calibration on validation frames."""
    floor_px: float = 0.0
    """Standard deviation that is added to every keypoint [px of the crop]."""

    def __call__(self, image: np.ndarray, box_xyxy: Box | None = None) -> Keypoints:
        """Keypoints of the target; `box_xyxy` [px] (a filter's prediction) takes the finder's place."""
        grey = grey_8_bit(image)
        if is_blank(grey):
            return Keypoints.none("bad_image", self.n_keypoints)
        box = self.find_box(grey) if box_xyxy is None else box_xyxy
        if box is None:
            return Keypoints.none("no_target", self.n_keypoints)
        keypoints = self._look(grey, box)
        for _ in range(self.looks - 1):
            if keypoints.status != "ok":
                break
            keypoints = self._look(grey, _hull_box(keypoints, box))
        return keypoints

    def find_box(self, grey: np.ndarray) -> Box | None:
        """The target's box [px] in a grey frame, None when there is no target."""
        side = max(grey.shape)
        probability = self.find(cut(grey, Crop(0, 0, side), self.finder_side)[None])[0][0]
        patch = largest_patch(probability.astype(np.float64))
        return None if patch is None else patch[0] * (_CELL * side / self.finder_side)

    def _look(self, grey: np.ndarray, box: Box) -> Keypoints:
        """One crop round the box, read by the network."""
        crop = Crop.around(box, self.margin)
        points, scores, covariances, shown = self.read(cut(grey, crop, self.crop_side)[None])
        if shown[0] < self.min_shown:
            return Keypoints.none("no_target", self.n_keypoints)
        found = (scores[0] >= self.min_score)[:, None]
        pixels = np.where(found, crop.to_image(points[0].astype(np.float64), self.crop_side), np.nan)
        spread = covariances[0].astype(np.float64) * self.spread_scale**2 + np.eye(2) * self.floor_px**2
        spread *= (crop.size / self.crop_side) ** 2
        scores = np.where(found[:, 0], np.clip(scores[0].astype(np.float64), 0.0, 1.0), 0.0)
        return Keypoints("ok", pixels, spread, scores, box)


def _hull_box(keypoints: Keypoints, fallback: Box) -> Box:
    """The box of the keypoints that were found well; the last box when they are too few to say."""
    sure = keypoints.pixels[keypoints.scores > 0.3]
    if len(sure) < 8:
        return fallback
    return np.concatenate([sure.min(axis=0), sure.max(axis=0)])
