"""Training the crop network on samples that never repeat."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path

import numpy as np
import torch
from safetensors.torch import load_file
from torch import Tensor, nn

from proxnav.detection.heatmap.augment import AugmentConfig, augment
from proxnav.detection.heatmap.decode import decode
from proxnav.detection.heatmap.loss import LossConfig, keypoint_loss
from proxnav.detection.heatmap.network import STRIDE, HeatmapNet, HeatmapNetConfig, as_channels_last
from proxnav.detection.samples import SampleSource, TrainingSample, check_keypoint_count
from proxnav.detection.training.config import Learner, LoopConfig, TrainingResult, Validate

from proxnav.detection.training.loop import train
from proxnav.detection.training.rates import warm_up_then_cosine


@dataclass(frozen=True)
class TrainHeatmapConfig:
    """How the crop network is trained."""

    net: HeatmapNetConfig = field(default_factory=HeatmapNetConfig)
    loss: LossConfig = field(default_factory=LossConfig)
    augment: AugmentConfig = field(default_factory=AugmentConfig)
    loop: LoopConfig = field(default_factory=lambda: LoopConfig(steps=8000, batch_size=32, log_every=50))
    rate: float = 1e-3
    weight_decay: float = 0.02
    start: Path | None = None
    """Weights (safetensors) to start from, such as those of a smaller side."""


def train_heatmap(
    config: TrainHeatmapConfig, source: SampleSource, out: Path, validate: Validate | None = None
) -> TrainingResult:
    """Trains into `out`, resuming where it stopped; the weights are the running average."""
    torch.manual_seed(config.loop.seed)
    net = as_channels_last(HeatmapNet(config.net))
    if config.start is not None:
        net.load_state_dict(load_file(config.start))
    decayed, free = _by_dimension(net)
    groups = [{"params": decayed, "weight_decay": config.weight_decay}, {"params": free, "weight_decay": 0.0}]

    def collate(samples: list[TrainingSample], step: int, rng: np.random.Generator) -> dict[str, Tensor]:
        for sample in samples:
            check_keypoint_count(sample, config.net.n_keypoints)
        return batch_of([augment(sample, config.augment, rng) for sample in samples])

    def loss(model: nn.Module, batch: dict[str, Tensor]) -> dict[str, Tensor]:
        maps = model(batch["image"].contiguous(memory_format=torch.channels_last))
        return keypoint_loss(maps, batch["keypoints"], batch["visibility"], batch["mask"], config.loss)

    learner = Learner(
        model=net,
        optimizer=torch.optim.AdamW(groups, lr=config.rate, betas=(0.9, 0.99)),
        rate=warm_up_then_cosine(config.rate, config.loop.steps),
        collate=collate,
        loss=loss,
        notes={"detector": "heatmap"} | asdict(config.net),
    )
    return train(learner, source, config.loop, out, validate)


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


def keypoint_errors(net: nn.Module, samples: Sequence[TrainingSample], batch_size: int = 32) -> np.ndarray:
    """(samples, n) distance of each decoded keypoint from its label [px of the crop]; NaN outside the crop."""
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


def _cells(sample: TrainingSample) -> np.ndarray:
    """(h / stride, w / stride) share of each cell that shows the target."""
    h, w = sample.image.shape
    mask = np.zeros((h, w), np.float32) if sample.mask is None else sample.mask.astype(np.float32)
    return mask.reshape(h // STRIDE, STRIDE, w // STRIDE, STRIDE).mean(axis=(1, 3))


def _by_dimension(net: nn.Module) -> tuple[list[nn.Parameter], list[nn.Parameter]]:
    """(weights of layers, biases and norms): only the first decay."""
    parameters = list(net.parameters())
    return [p for p in parameters if p.ndim > 1], [p for p in parameters if p.ndim <= 1]
