"""Training Keypoint R-CNN: the study's recipe, and one for two processor cores."""

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch
from jaxtyping import Float
from torch import Tensor, nn

from proxnav.detection.keypoint_rcnn.config import STUDY, STUDY_SMALL, NetworkConfig
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.keypoint_rcnn.views import in_view, padded, whole, zoomed
from proxnav.detection.keypoint_rcnn.weights import DETECTOR, start_from
from proxnav.detection.samples import SampleSource, TrainingSample, check_keypoint_count
from proxnav.detection.training.config import SEED, LoopConfig
from proxnav.detection.training.learner import Learner, TrainingResult, Validate
from proxnav.detection.training.loop import train
from proxnav.detection.training.rates import Rate, per_epoch, warm_up_then_cosine
from proxnav.errors import InputError


@dataclass(frozen=True)
class Stage:
    """A part of the run with its own view of the samples."""

    until: float
    """Share of the run's steps at which the stage ends."""
    side: int
    """Side of the square that the network is given [px], a multiple of 32."""
    zoom_share: float = 0.0
    """Share of the samples that are cropped to a square round the target instead of whole."""


@dataclass(frozen=True)
class TrainKeypointRcnnConfig:
    """How Keypoint R-CNN is trained."""

    network: NetworkConfig = field(default_factory=lambda: STUDY_SMALL)
    loop: LoopConfig = field(default_factory=lambda: LoopConfig(steps=3000, batch_size=8, validate_every=500))
    optimizer: Literal["sgd", "adamw"] = "adamw"
    """sgd: momentum 0.9, weight decay 1e-4; adamw: betas 0.9 and 0.99, weight decay 0.02 on weights of layers."""
    rate: float = 1e-3
    schedule: Literal["per_epoch", "cosine"] = "cosine"
    """per_epoch: times 0.98 per epoch; cosine: warm-up over 100 steps, then half a cosine to a hundredth."""
    steps_per_epoch: int = 0
    """For per_epoch: training images over batch size, times accumulation and processes."""
    stages: tuple[Stage, ...] = ()
    """A curriculum in order; none trains on whole images at the network's side."""
    start: Path | None = None
    """Weights (safetensors or a torch state dict) to start from: of this network, of its backbone, or ImageNet's."""


def study(n_images: int = 4500, batch_size: int = 4, epochs: int = 200) -> TrainKeypointRcnnConfig:
    """The seed study's recipe: rate 1e-3 times 0.98 per epoch, 200 epochs over 4500 images.

    The study does not name its optimiser; this is the one of torchvision's detection references, SGD with momentum.
    """
    per = n_images // batch_size
    loop = LoopConfig(steps=epochs * per, batch_size=batch_size, save_every=per, validate_every=per)
    return TrainKeypointRcnnConfig(STUDY, loop, optimizer="sgd", schedule="per_epoch", steps_per_epoch=per)


def study_small(steps: int = 3000, side: int = 320) -> TrainKeypointRcnnConfig:
    """The same network with slimmer heads, for two cores: small zoomed views first, whole frames at the end."""
    stages = (Stage(0.5, 128, 1.0), Stage(0.8, 192, 0.6), Stage(1.0, side, 0.3))
    loop = LoopConfig(steps=steps, batch_size=16, validate_every=500)
    return TrainKeypointRcnnConfig(replace(STUDY_SMALL, side=side), loop, stages=stages)


def train_keypoint_rcnn(
    config: TrainKeypointRcnnConfig, source: SampleSource, out: Path, validate: Validate | None = None
) -> TrainingResult:
    """Trains into the folder `out`, resuming where it stopped; `validate` scores the averaged network."""
    _check(config)
    torch.manual_seed(SEED)
    network = KeypointRcnn(config.network)
    if config.start is not None and not (out / "checkpoint.pt").exists():
        start_from(network, config.start)
    learner = Learner(
        model=network,
        optimizer=_optimizer(network, config),
        rate=_rate(config),
        collate=_collate(config),
        loss=lambda model, batch: model(batch),
        notes={"detector": DETECTOR} | config.network.to_json(),
    )
    return train(learner, source, config.loop, out, validate)


def batch_of(samples: list[TrainingSample], network: NetworkConfig) -> dict[str, Any]:
    """Square samples of one side as tensors: images, boxes, has_target, keypoints, labelled and, if wanted, masks."""
    side = samples[0].image.shape[0]
    boxes = [padded(s.box_xyxy, network.box_padding, side) if s.has_target else np.zeros(4) for s in samples]
    batch = {
        "images": torch.from_numpy(np.stack([s.image for s in samples])),
        "boxes": torch.from_numpy(np.stack(boxes).astype(np.float32)),
        "has_target": torch.tensor([s.has_target for s in samples]),
        "keypoints": torch.from_numpy(np.stack([np.nan_to_num(s.keypoints_px) for s in samples]).astype(np.float32)),
        "labelled": torch.from_numpy(np.stack([(s.visibility > 0) & s.has_target for s in samples])),
    }
    if network.mask:
        batch["masks"] = torch.from_numpy(np.stack([_mask(s) for s in samples]))
    return batch


def _mask(sample: TrainingSample) -> Float[np.ndarray, "height width"]:
    if sample.mask is None:
        raise InputError("a sample has no mask, but the network has a mask head: give masks or set mask to false")
    return sample.mask.astype(np.float32)


def _collate(config: TrainKeypointRcnnConfig) -> Any:
    def collate(samples: list[TrainingSample], step: int, rng: np.random.Generator) -> dict[str, Tensor]:
        stage = _stage(config, step)
        given = []
        for sample in samples:
            check_keypoint_count(sample, config.network.n_keypoints)
            near = sample.has_target and rng.random() < stage.zoom_share
            view = zoomed(sample.box_xyxy, rng) if near else whole(sample.image)
            given.append(in_view(sample, view, stage.side))
        return batch_of(given, config.network)

    return collate


def _stage(config: TrainKeypointRcnnConfig, step: int) -> Stage:
    for stage in config.stages:
        if step < stage.until * config.loop.steps:
            return stage
    return config.stages[-1] if config.stages else Stage(1.0, config.network.side)


def _optimizer(network: nn.Module, config: TrainKeypointRcnnConfig) -> torch.optim.Optimizer:
    parameters = [p for p in network.parameters() if p.requires_grad]
    if config.optimizer == "sgd":
        return torch.optim.SGD(parameters, lr=config.rate, momentum=0.9, weight_decay=1e-4)
    groups = [
        {"params": [p for p in parameters if p.ndim > 1], "weight_decay": 0.02},
        {"params": [p for p in parameters if p.ndim <= 1], "weight_decay": 0.0},
    ]
    return torch.optim.AdamW(groups, lr=config.rate, betas=(0.9, 0.99))


def _rate(config: TrainKeypointRcnnConfig) -> Rate:
    if config.schedule == "per_epoch":
        return per_epoch(config.rate, 0.98, config.steps_per_epoch)
    return warm_up_then_cosine(config.rate)


def _check(config: TrainKeypointRcnnConfig) -> None:
    for side in (config.network.side, *(stage.side for stage in config.stages)):
        if side < 64 or side % 32:
            raise InputError(f"side {side}: the network needs a multiple of 32, 64 or more")
    if config.schedule == "per_epoch" and config.steps_per_epoch < 1:
        raise InputError("schedule per_epoch needs steps_per_epoch: training images over batch size")
