"""Training the crop network on samples that never repeat."""

from collections.abc import Callable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from proxnav.detection.heatmap.augment import Turns, augment
from proxnav.detection.heatmap.config import TrainFinderConfig, TrainHeatmapConfig
from proxnav.detection.heatmap.decode import decode
from proxnav.detection.heatmap.finder import TRUNK, WIDTH, FinderNet
from proxnav.detection.heatmap.loss import keypoint_loss
from proxnav.detection.heatmap.network import HeatmapNet
from proxnav.detection.heatmap.pyramid import STRIDE, as_channels_last
from proxnav.detection.samples import SampleSource, TrainingSample, check_keypoint_count
from proxnav.detection.training.config import SEED
from proxnav.detection.training.files import load_fitting, load_weights
from proxnav.detection.training.learner import Learner, TrainingResult, Validate
from proxnav.detection.training.loop import train
from proxnav.detection.training.rates import warm_up_then_cosine

_WEIGHT_DECAY = 0.02


def train_heatmap(
    config: TrainHeatmapConfig, n_keypoints: int, source: SampleSource, out: Path, validate: Validate | None = None,
    turns: Turns = "small",
) -> TrainingResult:  # fmt: skip
    """Trains the crop network into `out`, resuming where it stopped; the weights are the running average."""

    def loss(model: nn.Module, batch: dict[str, Tensor]) -> dict[str, Tensor]:
        maps = model(batch["image"].contiguous(memory_format=torch.channels_last))
        return keypoint_loss(maps, batch["keypoints"], batch["visibility"], batch["mask"])

    torch.manual_seed(SEED)
    notes = {"detector": "heatmap", "n_keypoints": n_keypoints} | asdict(config.net)
    learner = _learner(HeatmapNet(config.net, n_keypoints), config, loss, notes, n_keypoints, turns)
    return train(learner, source, config.loop, out, validate)


def train_finder(
    config: TrainFinderConfig, source: SampleSource, out: Path, validate: Validate | None = None, turns: Turns = "small"
) -> TrainingResult:
    """Trains the finder into `out` on cross-entropy of each cell and overlap of the whole."""

    def loss(model: nn.Module, batch: dict[str, Tensor]) -> dict[str, Tensor]:
        logits = model(batch["image"].contiguous(memory_format=torch.channels_last)).float()[:, 0]
        each = nn.functional.binary_cross_entropy_with_logits(logits, batch["mask"], reduction="none")
        overlap = soft_overlap(logits.sigmoid(), batch["mask"])
        return {"cell": each.mean(), "overlap": 1.0 - overlap.mean()}

    torch.manual_seed(SEED)
    notes = {"detector": "finder", "trunk": TRUNK, "width": WIDTH}
    learner = _learner(FinderNet(), config, loss, notes, None, turns)
    return train(learner, source, config.loop, out, validate)


def soft_overlap(p: Tensor, mask: Tensor) -> Tensor:
    """(b,) Dice overlap 2 |p m| / (|p| + |m|) of probabilities and masks; 1 where both are empty."""
    both, either = (p * mask).sum(dim=(-2, -1)), (p + mask).sum(dim=(-2, -1))
    return (2.0 * both + 1.0) / (either + 1.0)


def _learner(
    net: nn.Module,
    config: TrainHeatmapConfig | TrainFinderConfig,
    loss: Callable[[nn.Module, dict[str, Tensor]], dict[str, Tensor]],
    notes: dict[str, Any],
    n_keypoints: int | None,
    turns: Turns,
) -> Learner:
    if isinstance(config, TrainHeatmapConfig) and config.trunk is not None:
        load_fitting(net, config.trunk)
    if config.start is not None:
        load_weights(net, config.start)

    def collate(samples: list[TrainingSample], step: int, rng: np.random.Generator) -> dict[str, Tensor]:
        for sample in samples:
            if n_keypoints is not None:
                check_keypoint_count(sample, n_keypoints)
        return batch_of([augment(sample, rng, turns) for sample in samples])

    decayed, free = _by_dimension(net)
    groups = [{"params": decayed, "weight_decay": _WEIGHT_DECAY}, {"params": free, "weight_decay": 0.0}]
    return Learner(
        model=as_channels_last(net),
        optimizer=torch.optim.AdamW(groups, lr=config.rate, betas=(0.9, 0.99), fused=True),
        rate=warm_up_then_cosine(config.rate),
        collate=collate,
        loss=loss,
        notes=notes,
    )


def batch_of(samples: Sequence[TrainingSample]) -> dict[str, Tensor]:
    """Tensors of a batch: image (b, 1, h, w) in [0, 1], keypoints (b, n, 2) in cells, visibility, mask in cells."""
    images = np.stack([sample.image for sample in samples]).astype(np.float32) / 255.0
    keypoints = np.stack([np.nan_to_num(sample.keypoints_px, nan=-1e3) for sample in samples]) / STRIDE
    masks = np.stack([_cells(sample) for sample in samples])
    visibility = np.stack([sample.visibility for sample in samples])
    return {
        "image": torch.from_numpy(images[:, None]),
        "keypoints": torch.from_numpy(keypoints.astype(np.float32)),
        "visibility": torch.from_numpy(visibility),
        "mask": torch.from_numpy(masks),
    }


def keypoint_errors(
    net: nn.Module, samples: Sequence[TrainingSample], batch_size: int = 32
) -> Float[np.ndarray, "n_samples n_keypoints"]:
    """Distance of each decoded keypoint from its label [px of the crop]; NaN outside the crop."""
    net.eval()
    errors = []
    for start in range(0, len(samples), batch_size):
        batch = batch_of(samples[start : start + batch_size])
        with torch.inference_mode():
            points, _ = decode(net(batch["image"].contiguous(memory_format=torch.channels_last)).logits)
        distance = (points - batch["keypoints"]).norm(dim=-1) * STRIDE
        height, width = batch["image"].shape[-2:]
        limit = torch.tensor([width, height]) / STRIDE
        inside = ((batch["keypoints"] >= 0) & (batch["keypoints"] < limit)).all(dim=-1)
        errors.append(torch.where(inside, distance, torch.nan).numpy())
    return np.concatenate(errors)


def _cells(sample: TrainingSample) -> Float[np.ndarray, "rows columns"]:
    """Share of each cell that shows the target."""
    h, w = sample.image.shape
    mask = np.zeros((h, w), np.float32) if sample.mask is None else sample.mask.astype(np.float32)
    return mask.reshape(h // STRIDE, STRIDE, w // STRIDE, STRIDE).mean(axis=(1, 3))


def _by_dimension(net: nn.Module) -> tuple[list[nn.Parameter], list[nn.Parameter]]:
    """(weights of layers, biases and norms): only the first decay."""
    parameters = list(net.parameters())
    return [p for p in parameters if p.ndim > 1], [p for p in parameters if p.ndim <= 1]
