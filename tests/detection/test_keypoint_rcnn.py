"""Keypoint R-CNN: its parts, its losses, what is read off its maps, its files."""

import signal
from collections.abc import Iterator
from dataclasses import replace
from itertools import count
from pathlib import Path

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from torch import nn
from torchvision.models import resnet18
from torchvision.models.detection.roi_heads import keypointrcnn_loss
from torchvision.ops.misc import FrozenBatchNorm2d

from drawings import drawing, drawings
from proxnav.detection.keypoint_rcnn.calibrate import fit_calibration
from proxnav.detection.keypoint_rcnn.config import STUDY_SMALL, NetworkConfig
from proxnav.detection.keypoint_rcnn.decode import Calibration, covariances, decode_maps
from proxnav.detection.keypoint_rcnn.detect import DetectConfig, Found, detect
from proxnav.detection.keypoint_rcnn.losses import bilinear_weights, keypoint_loss
from proxnav.detection.keypoint_rcnn.masks import paste
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.keypoint_rcnn.onnx_export import export_onnx
from proxnav.detection.keypoint_rcnn.onnx_runtime import load_onnx
from proxnav.detection.keypoint_rcnn.predict import predict, predict_with_mask
from proxnav.detection.keypoint_rcnn.train import (
    Stage,
    TrainKeypointRcnnConfig,
    batch_of,
    study,
    study_small,
    train_keypoint_rcnn,
)
from proxnav.detection.keypoint_rcnn.views import in_view
from proxnav.detection.keypoint_rcnn.weights import load_network, packed, save_network, start_from, unpacked
from proxnav.detection.samples import TrainingSample
from proxnav.detection.training.config import LoopConfig
from proxnav.errors import InputError
from proxnav.images.crop import Crop

SIDE = 96
NORMS = (nn.BatchNorm2d, nn.GroupNorm, FrozenBatchNorm2d)
TINY = replace(
    STUDY_SMALL, depth=18, side=SIDE, pyramid_channels=32, anchor_sizes=(16, 32, 48, 64, 96), candidates=50,
    proposals=32, boxes_per_image=16, box_features=64, keypoint_widths=(64, 64), keypoint_rois=2, mask_widths=(16,),
)  # fmt: skip


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    torch.manual_seed(3)
    yield
    torch.set_num_threads(before)


def samples(n: int, tilt: float = 0.5) -> list[TrainingSample]:
    return [drawing(np.random.default_rng([1, index]), SIDE, tilt) for index in range(n)]


def gaussian_maps(points: np.ndarray, box: np.ndarray, sigma_cells: float, side: int = 56) -> np.ndarray:
    """Logits of Gaussians about `points` over the cells of a box, by the cells' centres in the image."""
    cell = (box[2:] - box[:2]) / side
    x, y = (box[k] + (np.arange(side) + 0.5) * cell[k] for k in (0, 1))
    dx, dy = (x - points[:, :1]) / cell[0], (y - points[:, 1:]) / cell[1]
    return -(dx[:, None, :] ** 2 + dy[:, :, None] ** 2) / (2 * sigma_cells**2)


@pytest.mark.parametrize(("norm", "expected"), [("batch", nn.BatchNorm2d), ("group", nn.GroupNorm)])
def test_no_norm_is_frozen_and_every_weight_is_trained(norm: str, expected: type[nn.Module]) -> None:
    network = KeypointRcnn(replace(TINY, norm=norm))
    kinds = [type(layer) for layer in network.parts.backbone.modules() if isinstance(layer, NORMS)]
    assert FrozenBatchNorm2d not in kinds
    assert set(kinds) == {expected}
    assert len(kinds) == 20 + 8  # of ResNet-18 and of the pyramid
    assert all(weight.requires_grad for weight in network.parameters())


@given(st.floats(20.0, 40.0), st.floats(15.0, 45.0), st.floats(0.8, 1.1))
def test_decoding_a_map_has_no_half_pixel_bias(x: float, y: float, sigma: float) -> None:
    box = np.array([10.25, -3.5, 50.0, 60.75])
    points = np.array([[x, y]])
    found, spread, score = decode_maps(gaussian_maps(points, box, sigma), box)
    cell = (box[2:] - box[:2]) / 56
    np.testing.assert_allclose(found, points, atol=0.02)  # px, half a pixel is 0.5
    np.testing.assert_allclose(np.diag(spread[0]), (sigma * cell) ** 2, rtol=0.1)
    assert 0.97 < score[0] <= 1.0 + 1e-9


def test_a_second_mode_takes_from_the_score_and_not_from_the_point() -> None:
    box = np.array([0.0, 0.0, 56.0, 56.0])
    both = np.array([[10.3, 12.6], [40.0, 45.0]])
    p = np.exp(gaussian_maps(both, box, 1.0))
    maps = np.log(0.7 * p[:1] + 0.3 * p[1:] + 1e-30)
    found, _, score = decode_maps(maps, box)
    np.testing.assert_allclose(found[0], both[0], atol=0.01)  # px
    assert score[0] == pytest.approx(0.7, abs=0.02)


def test_maps_at_the_rim_decode_inside_the_box() -> None:
    box = np.array([0.0, 0.0, 28.0, 28.0])
    found, spread, _ = decode_maps(gaussian_maps(np.array([[0.0, 28.0]]), box, 1.0), box)
    assert (found >= 0).all()
    assert (found <= 28).all()
    assert np.isfinite(spread).all()


def test_covariances_scale_with_the_view_and_never_fall_below_the_floor() -> None:
    result = covariances(np.zeros((2, 2, 2)), 3.2, Calibration(floor_px=0.4))
    np.testing.assert_allclose(result, np.tile(0.16 * np.eye(2), (2, 1, 1)))
    scaled = covariances(np.eye(2)[None], 3.0, Calibration(scale=2.0, floor_px=0.0))
    np.testing.assert_allclose(scaled[0], 18.0 * np.eye(2))


def test_calibration_recovers_scale_and_floor_despite_mistakes(rng: np.random.Generator) -> None:
    spreads = rng.uniform(0.05, 9.0, 6000)[:, None, None] * np.eye(2)
    true = covariances(spreads, 1.0, Calibration(scale=2.5, floor_px=0.5))
    heavy = np.sqrt(4.0 / rng.chisquare(4.0, 6000))[:, None]
    errors = heavy * np.einsum("nij,nj->ni", np.linalg.cholesky(true), rng.normal(size=(6000, 2)))
    errors[:60] += 200.0  # one in a hundred on the wrong corner
    fitted = fit_calibration(errors, spreads)
    assert fitted.scale == pytest.approx(2.5, rel=0.15)
    assert fitted.floor_px == pytest.approx(0.5, rel=0.2)


def test_calibration_needs_enough_keypoints() -> None:
    with pytest.raises(InputError, match="0 keypoints found"):
        fit_calibration(np.full((50, 2), np.nan), np.ones((50, 2, 2)))


@given(st.floats(0.5, 55.5), st.floats(0.5, 55.5))
def test_the_mean_of_a_bilinear_label_is_the_point(x: float, y: float) -> None:
    index, weight = bilinear_weights(torch.tensor([[[x, y]]], dtype=torch.float64), 56)
    assert weight.sum().item() == pytest.approx(1.0)
    assert ((index % 56 + 0.5) * weight).sum().item() == pytest.approx(x, abs=1e-9)
    assert ((index // 56 + 0.5) * weight).sum().item() == pytest.approx(y, abs=1e-9)


def test_cell_labels_are_torchvisions_loss(rng: np.random.Generator) -> None:
    maps = torch.from_numpy(rng.normal(size=(3, 6, 56, 56))).float()
    rois = torch.tensor([[2.0, 3.0, 60.0, 50.0], [0.0, 0.0, 30.0, 90.0], [10.0, 10.0, 20.0, 20.0]])
    keypoints = torch.from_numpy(rng.uniform(0, 60, (3, 6, 2))).float()
    labelled = torch.from_numpy(rng.random((3, 6)) < 0.7)
    points = [torch.cat((k, v[:, None]), 1)[None] for k, v in zip(keypoints, labelled, strict=True)]
    theirs = keypointrcnn_loss(maps, list(rois[:, None]), points, [torch.zeros(1, dtype=torch.int64)] * 3)
    ours = keypoint_loss(maps, rois, keypoints, labelled, "cell")
    assert ours.item() == pytest.approx(theirs.item(), rel=1e-5)


@pytest.mark.parametrize("norm", ["batch", "group"])
def test_every_weight_gets_a_gradient_with_and_without_a_target(norm: str) -> None:
    network = KeypointRcnn(replace(TINY, norm=norm, mask=True)).train()
    empty = [replace(s, box_xyxy=np.full(4, np.nan), mask=np.zeros((SIDE, SIDE), bool)) for s in samples(2)]
    for shown in (samples(2), empty):
        network.zero_grad()
        losses = network(batch_of(shown, network.config))
        total = torch.stack(list(losses.values())).sum()
        total.backward()
        assert torch.isfinite(total)
        assert set(losses) == {"loss_objectness", "loss_rpn_box_reg", "classifier", "box", "keypoint", "mask"}
        assert all(weight.grad is not None for weight in network.parameters())
    assert losses["keypoint"].item() == losses["mask"].item() == 0.0


def dot(x: float, y: float) -> np.ndarray:
    """An image with a Gaussian spot at a corner-origin point."""
    columns, rows = np.arange(80) + 0.5, np.arange(64) + 0.5
    value = 250 * np.exp(-((columns - x) ** 2 + (rows[:, None] - y) ** 2) / (2 * 4.0**2))
    return value.astype(np.uint8)


def centroid(image: np.ndarray) -> np.ndarray:
    rows, columns = np.indices(image.shape) + 0.5
    return np.array([(columns * image).sum(), (rows * image).sum()]) / image.sum()


@pytest.mark.parametrize("view", [Crop(0, 0, 80), Crop(14, -3, 48), Crop(10, 4, 48)])
def test_what_the_network_sees_agrees_with_its_labels(view: Crop) -> None:
    point = np.array([34.3, 27.8])
    sample = TrainingSample(dot(*point), point[None], np.array([2]), np.array([*(point - 3), *(point + 3)]))
    seen = in_view(sample, view, 64)
    np.testing.assert_allclose(centroid(seen.image.astype(float)), seen.keypoints_px[0], atol=0.1)  # px
    np.testing.assert_allclose((seen.box_xyxy[:2] + seen.box_xyxy[2:]) / 2, seen.keypoints_px[0], atol=1e-9)


def test_points_beyond_the_view_are_not_labelled() -> None:
    sample = TrainingSample(
        np.zeros((64, 80), np.uint8), np.array([[70.0, 30.0], [20.0, 20.0]]), np.array([2, 1]),
        np.array([10.0, 10.0, 75.0, 40.0]),
    )  # fmt: skip
    seen = in_view(sample, Crop(0, 0, 40), 80)
    assert seen.visibility.tolist() == [0, 1]
    np.testing.assert_allclose(seen.box_xyxy, [20, 20, 80, 80])


def finder(point: np.ndarray, score: float = 0.9):
    """Stands for a network: a box round the brightest spot of its square, with maps about that spot's centroid."""

    def run(picture: np.ndarray) -> Found:
        at = centroid(picture.astype(float))
        box = np.array([*(at - 10.3), *(at + 12.1)])
        return Found(box, score, gaussian_maps(at[None], box, 1.0))

    return run


@pytest.mark.parametrize("passes", [1, 2])
@pytest.mark.parametrize("kind", ["grey", "colour", "16 bit"])
def test_keypoints_come_back_in_pixels_of_the_full_image(passes: int, kind: str) -> None:
    point = np.array([41.3, 27.8])
    image = dot(*point)
    image = {"grey": image, "colour": np.dstack([image] * 3), "16 bit": image.astype(np.uint16) << 4}[kind]
    found = detect(finder(point), image, 64, 1, DetectConfig(passes=passes)).keypoints
    assert found.status == "ok"
    np.testing.assert_allclose(found.pixels[0], point, atol=0.1)  # px
    assert (np.linalg.eigvalsh(found.covariances_px2) > 0).all()


def test_without_a_good_box_there_is_no_target() -> None:
    found = detect(finder(np.zeros(2), score=0.3), dot(30, 30), 64, 1, DetectConfig()).keypoints
    assert found.status == "no_target"
    assert np.isnan(found.pixels).all()


@pytest.mark.parametrize("image", [np.zeros((0, 5), np.uint8), np.zeros((5, 5)), np.zeros(7, np.uint8)])
def test_what_is_no_image_has_a_status(image: np.ndarray) -> None:
    assert detect(finder(np.zeros(2)), image, 64, 6, DetectConfig()).keypoints.status == "bad_image"


def test_a_mask_is_laid_over_its_box() -> None:
    disc = np.hypot(*(np.indices((28, 28)) - 13.5)) < 12
    mask = paste(disc.astype(float), np.array([20.0, 10.0, 48.0, 66.0]), (100, 120))
    rows, columns = np.nonzero(mask)
    np.testing.assert_allclose([columns.mean() + 0.5, rows.mean() + 0.5], [34.0, 38.0], atol=0.05)  # px
    assert mask.sum() == pytest.approx(np.pi * 12 * 24, rel=0.02)  # half axes in pixels


def test_eight_bits_lose_at_most_half_a_step_a_weight() -> None:
    state = KeypointRcnn(TINY).state_dict()
    back = unpacked(packed(state))
    assert back.keys() == state.keys()
    for name, value in state.items():
        step = value.abs().flatten(1).amax(1) / 127 if value.ndim > 1 else torch.zeros(())
        assert (back[name] - value).abs().max() <= 0.5001 * step.max(), name


def test_a_saved_network_loads_as_it_was(tmp_path: Path) -> None:
    network = KeypointRcnn(replace(TINY, mask=True))
    save_network(network, tmp_path / "small.safetensors", {"seed": 4})
    loaded, notes = load_network(tmp_path / "small.safetensors")
    assert loaded.config == network.config
    assert notes["seed"] == 4
    assert predict_with_mask(loaded, samples(1)[0].image, DetectConfig(min_score=0.0)).mask is not None


def test_the_study_small_network_is_under_45_megabytes() -> None:
    state = packed(KeypointRcnn(STUDY_SMALL).state_dict())
    assert sum(tensor.numel() * tensor.element_size() for tensor in state.values()) < 45e6


def test_colour_weights_of_imagenet_start_the_grey_backbone(tmp_path: Path) -> None:
    theirs = resnet18(weights=None).state_dict()
    torch.save(theirs, tmp_path / "resnet18.pth")
    network = KeypointRcnn(TINY)
    n = start_from(network, tmp_path / "resnet18.pth")
    own = network.state_dict()
    assert n == len(theirs) - 2  # all but the classifier
    first = own["parts.backbone.body.conv1.weight"]
    torch.testing.assert_close(first, theirs["conv1.weight"].sum(1, keepdim=True))
    torch.testing.assert_close(own["parts.backbone.body.layer4.1.bn2.weight"], theirs["layer4.1.bn2.weight"])


@pytest.mark.parametrize(("content", "message"), [(None, "no weights at"), (b"junk", "neither safetensors nor")])
def test_weights_that_cannot_be_used_are_one_sentence(tmp_path: Path, content: bytes | None, message: str) -> None:
    path = tmp_path / "given.safetensors"
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(InputError, match=message):
        start_from(KeypointRcnn(TINY), path)


def test_presets_are_the_published_recipe_and_the_small_one() -> None:
    published, small = study(), study_small()
    assert published.network == NetworkConfig()
    assert published.loop.steps * published.loop.batch_size == 200 * 4500
    assert (published.rate, published.schedule) == (1e-3, "per_epoch")
    assert small.stages[-1] == Stage(1.0, small.network.side, small.stages[-1].zoom_share)


def tiny_run(steps: int, **loop) -> TrainKeypointRcnnConfig:
    defaults = dict(steps=steps, batch_size=2, accelerator="cpu", precision="32-true", deterministic=True, log_every=1)
    network = replace(TINY, depth=18, side=64, anchor_sizes=(8, 16, 32, 48, 64))
    stages = (Stage(0.5, 64, 1.0), Stage(1.0, 64, 0.0))
    return TrainKeypointRcnnConfig(network, LoopConfig(**(defaults | loop)), stages=stages)


def test_interrupted_training_of_the_network_resumes_exactly(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = train_keypoint_rcnn(tiny_run(3), drawings(SIDE, 0.5), tmp_path / "whole")
    forward, calls = KeypointRcnn.forward, count()

    def interrupted(self: KeypointRcnn, batch: dict) -> dict:
        if next(calls) == 1:
            signal.raise_signal(signal.SIGINT)
        return forward(self, batch)

    monkeypatch.setattr(KeypointRcnn, "forward", interrupted)
    with pytest.raises(KeyboardInterrupt):
        train_keypoint_rcnn(tiny_run(3), drawings(SIDE, 0.5), tmp_path / "parts")
    monkeypatch.undo()
    again = train_keypoint_rcnn(tiny_run(3), drawings(SIDE, 0.5), tmp_path / "parts")
    for name, value in whole.model.state_dict().items():
        assert torch.equal(value, again.model.state_dict()[name]), name


@pytest.mark.parametrize("change", [{"side": 100}, {"side": 32}])
def test_a_side_that_the_pyramid_cannot_halve_is_refused(change: dict[str, int], tmp_path: Path) -> None:
    config = TrainKeypointRcnnConfig(replace(TINY, **change))
    with pytest.raises(InputError, match="multiple of 32"):
        train_keypoint_rcnn(config, drawings(SIDE, 0.5), tmp_path)


def test_samples_with_other_keypoints_than_the_network_are_refused(tmp_path: Path) -> None:
    config = tiny_run(2)
    config = replace(config, network=replace(config.network, n_keypoints=5))
    with pytest.raises(InputError, match="a sample has 6 keypoints, the network 5"):
        train_keypoint_rcnn(config, drawings(SIDE, 0.5), tmp_path)


def test_a_mask_head_without_masks_is_refused() -> None:
    with pytest.raises(InputError, match="a sample has no mask"):
        batch_of([replace(samples(1)[0], mask=None)], replace(TINY, mask=True))


@pytest.mark.slow
def test_the_network_learns_a_solid_from_scratch_and_runs_without_torch(tmp_path: Path) -> None:
    loop = LoopConfig(steps=150, batch_size=8, log_every=10, average_decay=0.98, accelerator="cpu")
    config = TrainKeypointRcnnConfig(TINY, loop, rate=2e-3)
    result = train_keypoint_rcnn(config, drawings(SIDE, 0.5), tmp_path)
    network, _ = load_network(result.weights)
    fresh = [drawing(np.random.default_rng([99, index]), SIDE, 0.5) for index in range(30)]
    found = [predict(network, sample.image) for sample in fresh]
    assert [k.status for k in found].count("ok") >= 28
    distance = [np.linalg.norm(k.pixels - s.keypoints_px, axis=1) for k, s in zip(found, fresh, strict=True)]
    assert np.nanmedian(distance) < 1.0  # px of 96


@pytest.mark.slow
@pytest.mark.parametrize("bits", [8, 32])
def test_the_exported_graph_agrees_with_torch(tmp_path: Path, bits: int) -> None:
    network = KeypointRcnn(replace(TINY, norm="group", mask=True)).eval()
    with torch.no_grad():  # sharp maps, as after training
        network.parts.roi_heads.keypoint_predictor.kps_score_lowres.weight.mul_(3.0)
    if bits == 8:
        network.load_state_dict(unpacked(packed(network.state_dict())))
    export_onnx(network, tmp_path / "network.onnx", bits=bits)
    assert not network.training
    graph = load_onnx(tmp_path / "network.onnx", threads=1)
    every = DetectConfig(min_score=0.0)
    for sample in samples(10):
        ours, theirs = predict_with_mask(network, sample.image, every), graph.predict_with_mask(sample.image, every)
        np.testing.assert_allclose(theirs.keypoints.pixels, ours.keypoints.pixels, atol=0.05)  # px
        np.testing.assert_allclose(theirs.keypoints.box_xyxy, ours.keypoints.box_xyxy, atol=0.05)  # px
        assert ours.mask is not None
        assert theirs.mask is not None
        assert (ours.mask != theirs.mask).mean() < 1e-3
