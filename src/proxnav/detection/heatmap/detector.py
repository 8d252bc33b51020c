"""Full frame in, keypoints with covariances out: find, crop, read. Needs no torch."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.detection.heatmap.config import HeatmapSettings
from proxnav.detection.heatmap.patch import brightest_patches
from proxnav.detection.sessions import Session
from proxnav.geometry.types import Box, GreyImage, Image
from proxnav.images.crop import Crop, cut
from proxnav.images.quarter_turns import turned, turned_back
from proxnav.images.tones import grey_8_bit, is_blank
from proxnav.records import Keypoints

MIN_SCORE = 0.05
"""Keypoints whose peak holds less probability are reported as not found."""
_CELL = 4
"""Input pixels per cell of the finder's map."""
_MARGIN = 1.3
"""Side of the crop over the longer side of a box that is given."""
_SEARCH_MARGIN = 2.0
"""The same for a box of the finder, which may miss what is thin or dark: wider or closer where that is unsure."""
_CLOSER, _WIDER = 0.7, 2.25
"""Factors on that margin: a thin target fills too little of a wide crop, a dark one is larger than what was found."""
_PRESENCE = 0.3
"""Least probability of a cell of the finder's map to belong to the target; lower ones give wrong poses."""
_PATCHES = 2
"""Patches of the finder's map that are cropped: the largest may be a cloud."""
_SURE = 0.9
"""Median score at which no other crop is read."""
_CLOSE = 0.4
"""Doubt of the surest turn over that of the upright crop above which scores do not tell which of the two is right."""
_MIN_SHOWN = 0.02
"""Share of the crop that must show the target."""


@dataclass(frozen=True)
class HeatmapDetector:
    """The two networks and how their answers are read."""

    find: Session
    read: Session
    n_keypoints: int
    settings: HeatmapSettings = field(default_factory=HeatmapSettings)

    def __call__(self, image: Image) -> Keypoints:
        """Keypoints of the target, searched for in an image (uint8 or uint16, grey or colour)."""
        grey = grey_8_bit(image)
        return self._blank() if is_blank(grey) else self._best_crop(grey, self._find(grey))

    def detect_in(self, image: Image, box_xyxy: Box) -> Keypoints:
        """Keypoints in a crop round a box [px]: that of a first pose, or of a filter's prediction."""
        grey = grey_8_bit(image)
        return self._blank() if is_blank(grey) else self._surest_turn(grey, box_xyxy, _MARGIN)

    def _blank(self) -> Keypoints:
        return Keypoints.none("bad_image", self.n_keypoints)

    def _find(self, grey: GreyImage) -> list[Box]:
        """Boxes [px] in a grey frame in which the target may be, the likeliest first."""
        side, finder_side = max(grey.shape), self.settings.finder_side
        probability = self.find(cut(grey, Crop(0, 0, side), finder_side)[None])[0][0].astype(np.float64)
        scale = _CELL * side / finder_side
        return [box * scale for box in brightest_patches(probability, _PRESENCE, _PATCHES)]

    def _best_crop(self, grey: GreyImage, boxes: list[Box]) -> Keypoints:
        """Keypoints of the surest of several crops, the usual one first; mostly it is the only one."""
        best = Keypoints.none("no_target", self.n_keypoints)
        crops = [(box, margin) for margin in (_SEARCH_MARGIN, _SEARCH_MARGIN * _CLOSER) for box in boxes]
        crops += [(box, _SEARCH_MARGIN * _WIDER) for box in boxes[:1]]
        for box, margin in crops:
            found = self._surest_turn(grey, box, margin)
            if found.median_score > best.median_score:
                best = found
            if best.median_score >= _SURE:
                break
        return best

    def _surest_turn(self, grey: GreyImage, box: Box, margin: float) -> Keypoints:
        """Keypoints of one crop, of the surest of its turns by quarters where the settings ask for them.

        A network that knows little roll can be sure and wrong in a crop that lies on its side: all turns are read.
        """
        crop, side = Crop.around(box, margin), self.settings.crop_side
        square = cut(grey, crop, side)
        answers = self.read(np.stack([turned(square, quarters) for quarters in range(self.settings.turns)]))
        looks = [
            self._keypoints(crop, box, quarters, *(answer[quarters] for answer in answers))
            for quarters in range(self.settings.turns)
        ]
        best = max(looks, key=lambda look: look.lower_quartile_score)
        close = 1.0 - best.lower_quartile_score > _CLOSE * (1.0 - looks[0].lower_quartile_score)
        return replace(best, upright=looks[0]) if close and best is not looks[0] else best

    def _keypoints(
        self, crop: Crop, box: Box, quarters: int, points: Float[np.ndarray, "n 2"],
        scores: Float[np.ndarray, "n"], covariances: Float[np.ndarray, "n 2 2"], shown: Any,
    ) -> Keypoints:  # fmt: skip
        """What the network said of a crop turned by so many right angles, in the image."""
        if shown < _MIN_SHOWN:
            return Keypoints.none("no_target", self.n_keypoints)
        side, found = self.settings.crop_side, scores >= MIN_SCORE
        there, spread = points.astype(np.float64), covariances.astype(np.float64) * self.settings.spread_scale**2
        if quarters:
            there, spread = turned_back(there, spread, side, quarters)
        pixels = np.where(found[:, None], crop.to_image(there, side), np.nan)
        spread = spread * (crop.size / side) ** 2
        scores = np.where(found, np.clip(scores.astype(np.float64), 0.0, 1.0), 0.0)
        return Keypoints("ok", pixels, spread, scores, box)
