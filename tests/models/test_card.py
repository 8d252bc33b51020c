"""The model card: one reader, one writer, and refusals of one sentence."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.detection.heatmap.config import HeatmapNetConfig, HeatmapSettings
from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.errors import InputError
from proxnav.models.card import CARD, ModelCard, card_content, card_from, write_card
from proxnav.models.loading import SHIPPED
from proxnav.pose.align import AlignConfig

POINTS = np.arange(12.0).reshape(4, 3)
HEATMAP = ModelCard("x", tuple("abcd"), POINTS, HeatmapSettings(192, 256, 1.5), 0.9, HeatmapNetConfig(), AlignConfig())
RCNN = ModelCard("x", tuple("abcd"), POINTS, DetectConfig(0.4, 2, Calibration(2.0, 0.1)), 0.6)


@pytest.mark.parametrize("name", ["space-rider", "space-rider-study"])
def test_a_shipped_card_is_written_back_to_the_byte(name, tmp_path):
    folder = SHIPPED / name
    write_card(tmp_path, card_from(card_content(folder), folder))
    assert (tmp_path / CARD).read_bytes() == (folder / CARD).read_bytes()


@pytest.mark.parametrize("card", [HEATMAP, replace(HEATMAP, settings=HeatmapSettings(passes=1), alignment=None), RCNN])
def test_what_is_written_is_read_back(card, tmp_path):
    write_card(tmp_path, card)
    back = card_from(card_content(tmp_path), tmp_path)
    np.testing.assert_array_equal(back.keypoints_m, POINTS)
    for name in ("detector", "target", "keypoint_names", "settings", "least_median_score", "network", "alignment"):
        assert getattr(back, name) == getattr(card, name), name


def test_a_card_names_its_detector(tmp_path):
    assert (HEATMAP.detector, RCNN.detector) == ("heatmap", "keypoint-rcnn")
    with pytest.raises(InputError, match=r"model\.json: expected a detector among heatmap, keypoint-rcnn"):
        card_from({"target": "x"}, tmp_path)
