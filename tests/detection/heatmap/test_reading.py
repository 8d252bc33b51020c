"""The crop network's labels, maps and decoding agree about where things are."""

from typing import get_args

import numpy as np
import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from proxnav.detection.heatmap.augment import moved
from proxnav.detection.heatmap.config import HeatmapNetConfig, HeatmapSettings, Trunk
from proxnav.detection.heatmap.decode import covariances, decode, sample_spread
from proxnav.detection.heatmap.detector import HeatmapDetector
from proxnav.detection.heatmap.loss import _gaussian, keypoint_loss
from proxnav.detection.heatmap.network import HeatmapNet, Maps
from proxnav.detection.heatmap.patch import brightest_patches
from proxnav.detection.samples import TrainingSample
from proxnav.images.crop import Crop, cut

inside = st.floats(5.0, 27.0)
NO_MASK = torch.zeros(1, 32, 32)


@given(inside, inside)
def test_decoding_a_gaussian_gives_its_centre(x, y):
    p = _gaussian(torch.tensor([[[x, y]]]), 32, 32, 1.0)
    points, score = decode(torch.log(p.clamp_min(1e-30)))
    np.testing.assert_allclose(points[0, 0], [x, y], atol=0.02)  # cells
    assert score[0, 0] > 0.98


def test_two_modes_give_the_stronger_one_and_not_their_mean():
    near, far = (_gaussian(torch.tensor([[[x, 16.0]]]), 32, 32, 1.0) for x in (6.0, 26.0))
    points, score = decode(torch.log((0.6 * near + 0.4 * far).clamp_min(1e-30)))
    np.testing.assert_allclose(points[0, 0], [6.0, 16.0], atol=0.05)
    np.testing.assert_allclose(score[0, 0], 0.6, atol=0.02)


def _maps(point, log_sigma):
    logits = torch.log(_gaussian(torch.tensor([[point]]), 32, 32, 1.0).clamp_min(1e-30))
    spread = torch.tensor([*log_sigma, 0.0]).view(1, 3, 1, 1).expand(1, 3, 32, 32)
    return Maps(logits, spread, torch.zeros(1, 1, 32, 32))


def test_the_spread_term_is_least_at_the_true_deviation():
    truth = torch.tensor([[[16.0, 17.0]]])
    nll = [
        float(keypoint_loss(_maps([14.0, 16.0], (np.log(sx), 0.0)), truth, torch.tensor([[2]]), NO_MASK)["spread"])
        for sx in (1.0, 1.8, 2.0, 2.2, 4.0)
    ]  # fmt: skip
    assert np.argmin(nll) == 2  # the error along x is 2 cells


def test_covariances_are_what_log_sigma_and_correlation_say():
    spread = torch.tensor([[[np.log(2.0), np.log(0.5), 0.3]]])
    np.testing.assert_allclose(covariances(spread)[0, 0], [[4.0, 0.3], [0.3, 0.25]], rtol=1e-6)


def test_the_spread_is_read_in_the_cell_of_the_point():
    maps = torch.zeros(1, 3, 4, 5)
    maps[0, 0, 2, 3] = 1.5
    assert sample_spread(maps, torch.tensor([[[3.4, 2.9]]]))[0, 0, 0] == pytest.approx(1.5)
    assert sample_spread(maps, torch.tensor([[[2.9, 2.9]]]))[0, 0, 0] == 0.0


def test_points_outside_the_crop_carry_no_weight():
    maps = _maps([14.0, 16.0], (0.0, 0.0))
    truth = torch.tensor([[[-3.0, 8.0]]])
    terms = keypoint_loss(maps, truth, torch.tensor([[0]]), NO_MASK)
    assert float(terms["position"]) == 0.0


@pytest.mark.parametrize("trunk", get_args(Trunk))
def test_every_trunk_gives_a_quarter_of_the_resolution(trunk):
    maps = HeatmapNet(HeatmapNetConfig(trunk, 16), 7)(torch.rand(2, 1, 64, 96))
    assert maps.logits.shape == (2, 7, 16, 24)
    assert maps.spread.shape == (2, 21, 16, 24)
    assert maps.mask.shape == (2, 1, 16, 24)


@given(st.integers(-50, 200), st.integers(-50, 200), st.integers(33, 400), st.floats(0, 300), st.floats(0, 300))
def test_crop_coordinates_go_there_and_back(x, y, size, u, v):
    crop, pixel = Crop(x, y, size), np.array([u, v])
    np.testing.assert_allclose(crop.to_image(crop.to_network(pixel, 128), 128), pixel, atol=1e-9)


def _dot(image, centre):
    """Adds a Gaussian dot of 3 px at a corner-origin point."""
    y, x = np.mgrid[: image.shape[0], : image.shape[1]] + 0.5
    return image + 200.0 * np.exp(-((x - centre[0]) ** 2 + (y - centre[1]) ** 2) / 18.0)


def _centroid(image):
    y, x = np.mgrid[: image.shape[0], : image.shape[1]] + 0.5
    w = image.astype(float)
    return np.array([(x * w).sum(), (y * w).sum()]) / w.sum()


@pytest.mark.parametrize(
    ("crop", "side"), [(Crop(40, 30, 64), 128), (Crop(10, 20, 160), 64), (Crop(-20, -30, 150), 96)]
)
def test_a_cut_crop_shows_a_dot_where_its_coordinates_say(crop, side):
    dot = np.array([70.3, 61.8])
    image = np.round(_dot(np.zeros((200, 220)), dot)).astype(np.uint8)
    found = _centroid(cut(image, crop, side))
    np.testing.assert_allclose(found, crop.to_network(dot, side), atol=0.05)  # px


@pytest.mark.parametrize("turns", ["small", "any"])
@settings(max_examples=30)
@given(seed=st.integers(0, 10_000))
def test_augmentation_moves_labels_with_the_image(seed, turns):
    dot = np.array([60.2, 70.7])
    image = np.round(_dot(np.zeros((128, 128)), dot)).astype(np.uint8)
    sample = TrainingSample(image, dot[None], np.array([2]), np.array([50.0, 60.0, 70.0, 80.0]), image > 50)
    new = moved(sample, np.random.default_rng(seed), turns)
    np.testing.assert_allclose(_centroid(new.image), new.keypoints_px[0], atol=0.1)  # px
    assert new.mask is not None
    np.testing.assert_allclose(_centroid(new.mask), new.keypoints_px[0], atol=0.5)  # px


def test_the_largest_patch_wins_over_the_brightest_speck():
    p = np.zeros((20, 20))
    p[3, 3] = 1.0
    p[8:14, 5:12] = 0.7
    large, speck = brightest_patches(p, most=3)
    np.testing.assert_array_equal(large, [5, 8, 12, 14])
    np.testing.assert_array_equal(speck, [3, 3, 4, 4])
    assert brightest_patches(np.full((4, 4), 0.2)) == []


@pytest.mark.parametrize(("surest", "crops"), [(0, 1), (1, 2), (2, 3), (4, 5), (9, 5)])
def test_other_crops_are_read_until_one_is_sure(surest, crops):
    seen = []

    def find(frames):
        probability = np.zeros((1, 64, 64), np.float32)
        probability[0, 10:20, 10:20] = 0.9
        probability[0, 40:44, 40:44] = 0.9
        return [probability]

    def read(images):
        score = 0.97 if len(seen) == surest else 0.3 + 0.01 * len(seen)
        seen.append(images.shape)
        covariances = np.tile(np.eye(2, dtype=np.float32), (1, 4, 1, 1))
        points = np.full((1, 4, 2), 32.0, np.float32)
        return [points, np.full((1, 4), score, np.float32), covariances, np.ones(1, np.float32)]

    detector = HeatmapDetector(find, read, 4, HeatmapSettings(crop_side=64))
    keypoints = detector(np.random.default_rng(1).integers(0, 255, (256, 256)).astype(np.uint8))
    assert len(seen) == crops
    assert keypoints.median_score == pytest.approx(0.97 if surest < 5 else 0.34)


def test_a_keypoint_that_was_not_found_has_no_place_and_no_score():
    points = np.full((1, 3, 2), 32.0, np.float32)
    scores = np.array([[0.9, 0.01, 0.0]], np.float32)
    spread = np.tile(np.eye(2, dtype=np.float32), (1, 3, 1, 1))
    read = lambda crops: [points, scores, spread, np.ones(1)]  # noqa: E731
    detector = HeatmapDetector(read, read, 3, HeatmapSettings(crop_side=64))
    image = np.random.default_rng(1).integers(0, 255, (80, 80), dtype=np.uint8)
    found = detector.detect_in(image, np.array([10.0, 10.0, 60.0, 60.0]))
    np.testing.assert_array_equal(np.isfinite(found.pixels).all(axis=1), [True, False, False])
    np.testing.assert_allclose(found.scores, [0.9, 0.0, 0.0], atol=1e-6)


@pytest.mark.parametrize(
    ("upright", "turned", "kept"), [(0.5, 0.95, False), (0.95, 0.96, True), (0.96, 0.95, False)], ids=str
)
def test_the_upright_reading_is_kept_where_a_turned_one_is_hardly_surer(upright, turned, kept):
    def read(crops):
        scores = np.tile(np.array([upright, 0.1, turned, 0.1], np.float32)[:, None], (1, 4))
        return [np.full((4, 4, 2), 32.0), scores, np.tile(np.eye(2), (4, 4, 1, 1)), np.ones(4)]

    detector = HeatmapDetector(read, read, 4, HeatmapSettings(crop_side=64, turns=4))
    image = np.random.default_rng(1).integers(0, 255, (80, 80), dtype=np.uint8)
    found = detector.detect_in(image, np.array([10.0, 10.0, 60.0, 60.0]))
    assert found.median_score == pytest.approx(max(upright, turned))
    assert (found.upright is not None) == kept
    if found.upright is not None:
        assert found.upright.median_score == pytest.approx(upright)
