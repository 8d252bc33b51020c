"""Full frame in, keypoints with covariances out: find, crop, read. Needs no torch."""

from dataclasses import dataclass

import numpy as np

from proxnav.detection.heatmap.patch import brightest_patches
from proxnav.detection.sessions import Session
from proxnav.geometry.types import Box
from proxnav.images.crop import Crop, cut
from proxnav.images.tones import grey_8_bit, is_blank
from proxnav.records import Keypoints

_CELL = 4
"""Input pixels per cell of the finder's map."""
_CLOSER, _WIDER = 0.7, 2.25
"""Of the usual margin: a thin target fills too little of a wide crop, a dark one is larger than what was found."""
_PATCHES = 2
"""Of the finder's map that are looked at: the largest may be a cloud."""
_SURE = 0.9
"""Median score at which no other crop is looked at."""


@dataclass(frozen=True)
class HeatmapDetector:
    """The two networks and how their answers are read."""

    find: Session
    read: Session
    n_keypoints: int
    finder_side: int = 256
    crop_side: int = 256
    margin: float = 1.3
    """Side of the crop over the longer side of a box that is given."""
    search_margin: float = 2.0
    """The same for a box of the finder, which may miss what is thin or dark: wider or closer where that is unsure."""
    presence: float = 0.3
    """Least probability of a cell of the finder's map to belong to the target; lower ones give wrong poses."""
    min_score: float = 0.05
    """Keypoints whose peak holds less probability are reported as not found."""
    min_shown: float = 0.02
    """Share of the crop that must show the target."""
    spread_scale: float = 1.0
    """Factor on the standard deviations, from calibration on validation frames."""
    floor_px: float = 0.0
    """Standard deviation that is added to every keypoint [px of the crop]."""

    def __call__(self, image: np.ndarray, box_xyxy: Box | None = None) -> Keypoints:
        """Keypoints of the target; `box_xyxy` [px], of a first pose or a filter's prediction, replaces the finder."""
        grey = grey_8_bit(image)
        if is_blank(grey):
            return Keypoints.none("bad_image", self.n_keypoints)
        if box_xyxy is not None:
            return self._look(grey, box_xyxy, self.margin)
        return self._search(grey, self._find(grey))

    def _find(self, grey: np.ndarray) -> list[Box]:
        """Boxes [px] in a grey frame in which the target may be, the likeliest first."""
        side = max(grey.shape)
        probability = self.find(cut(grey, Crop(0, 0, side), self.finder_side)[None])[0][0].astype(np.float64)
        scale = _CELL * side / self.finder_side
        return [box * scale for box in brightest_patches(probability, self.presence, _PATCHES)]

    def _search(self, grey: np.ndarray, boxes: list[Box]) -> Keypoints:
        """The surest of several looks, the usual one first; mostly it is the only one."""
        best = Keypoints.none("no_target", self.n_keypoints)
        closer, wider = self.search_margin * _CLOSER, self.search_margin * _WIDER
        looks = [(box, margin) for margin in (self.search_margin, closer) for box in boxes]
        looks += [(box, wider) for box in boxes[:1]]
        for box, margin in looks:
            found = self._look(grey, box, margin)
            if found.median_score > best.median_score:
                best = found
            if best.median_score >= _SURE:
                break
        return best

    def _look(self, grey: np.ndarray, box: Box, margin: float) -> Keypoints:
        """One crop round the box, read by the network."""
        crop = Crop.around(box, margin)
        points, scores, covariances, shown = self.read(cut(grey, crop, self.crop_side)[None])
        if shown[0] < self.min_shown:
            return Keypoints.none("no_target", self.n_keypoints)
        found = (scores[0] >= self.min_score)[:, None]
        pixels = np.where(found, crop.to_image(points[0].astype(np.float64), self.crop_side), np.nan)
        spread = covariances[0].astype(np.float64) * self.spread_scale**2 + np.eye(2) * self.floor_px**2
        spread *= (crop.size / self.crop_side) ** 2
        scores = np.where(found[:, 0], np.clip(scores[0].astype(np.float64), 0.0, 1.0), 0.0)
        return Keypoints("ok", pixels, spread, scores, box)
