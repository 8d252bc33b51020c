"""Set-up of the seed study's network: by its recipe or by one for two cores, on fresh images or on a data set."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from proxnav.datasets.shards import is_sharded
from proxnav.detection.keypoint_rcnn.train import TrainKeypointRcnnConfig, study, study_small, train_keypoint_rcnn
from proxnav.detection.samples import SampleSource, TrainingSample, with_keypoints
from proxnav.detection.training.config import LoopConfig
from proxnav.detection.training.learner import TrainingResult, Validate
from proxnav.errors import InputError
from proxnav.geometry.types import Points
from proxnav.learning.crops import CropConfig, MixedJob
from proxnav.learning.drawn_stream import sample_source
from proxnav.learning.labelled_set import learnt_images, sample_reader, set_of_target, source_of
from proxnav.learning.rcnn_validation import fresh_frames, kept_aside, mean_e_c
from proxnav.learning.training import Training
from proxnav.missions import Mission
from proxnav.targets.loading import load_target

_CROP_SIDE = 160
_DRAW_SEED = 5


@dataclass(frozen=True)
class KeypointChoice:
    """Named keypoints of a target, and their places among all of them."""

    target: str
    names: tuple[str, ...]
    points_m: Points
    """Target frame [m]."""
    indices: tuple[int, ...]

    @staticmethod
    def of(target_name: str, subset: str) -> "KeypointChoice":
        """A named subset; all keypoints for an empty name."""
        target = load_target(target_name)
        if subset and subset not in target.subsets:
            raise InputError(f"target {target.name} has no keypoint subset '{subset}', only {list(target.subsets)}")
        indices = target.subsets[subset] if subset else tuple(range(len(target.keypoint_names)))
        names = tuple(target.keypoint_names[i] for i in indices)
        return KeypointChoice(target_name, names, target.keypoints_m[list(indices)], indices)


@dataclass(frozen=True)
class RcnnImages:
    """Which images are learnt from."""

    data: Path | None
    """Data set, a folder or shards; None draws every image fresh."""
    validation: int
    """Frames that choose the weights: the last of a folder, else fresh; 0 takes the last weights."""
    workers: int
    """Processes that draw."""
    repeats: int
    """Times that a drawn image is learnt from."""

    @property
    def folder(self) -> Path | None:
        """The data set where its frames can be counted and kept aside."""
        return None if self.data is None or is_sharded(self.data) else self.data


@dataclass(frozen=True)
class RcnnRecipe:
    """How long and how large, over the two named recipes."""

    preset: Literal["study", "study-small"]
    side: int
    """study-small: pixels of the square that the network sees."""
    steps: int
    """study-small: optimiser steps of 16 images."""
    minutes: float
    validate_every: int
    """Steps; 0 is the recipe's own."""
    patience: int
    mask: bool
    """A mask head as well."""
    devices: int
    start: Path | None
    """Weights to start from."""


def rcnn_training(mission: Mission, keypoints: KeypointChoice, images: RcnnImages, recipe: RcnnRecipe) -> Training:
    """Keypoint R-CNN, ready to be trained on the mission's target."""
    config = _config(keypoints, images, recipe)
    draw = MixedJob(CropConfig(mission.training_mission, _CROP_SIDE, _DRAW_SEED), recipe.side)
    if images.data is None:
        source, job = sample_source(draw, images.workers, images.repeats), draw
    else:
        source, job = source_of(images.data, keypoints.target, images.validation), _reader_job(images, keypoints)

    def learn(loop: LoopConfig, source: SampleSource, out: Path, validate: Validate | None) -> TrainingResult:
        chosen = with_keypoints(source, keypoints.indices)
        return train_keypoint_rcnn(replace(config, loop=loop), chosen, out, validate)

    return Training(
        learn=learn,
        loop=config.loop,
        draw=job,
        source=source,
        validate=_validate(mission, keypoints, images, config.network.side),
        workers=images.workers,
        repeats=images.repeats,
    )


def _config(keypoints: KeypointChoice, images: RcnnImages, recipe: RcnnRecipe) -> TrainKeypointRcnnConfig:
    config = _study(keypoints, images) if recipe.preset == "study" else study_small(recipe.steps, recipe.side)
    network = replace(config.network, n_keypoints=len(keypoints.names), mask=recipe.mask)
    every = recipe.validate_every or config.loop.validate_every
    loop = replace(
        config.loop, minutes=recipe.minutes, devices=recipe.devices, patience=recipe.patience,
        validate_every=every if images.validation else 0,
    )  # fmt: skip
    return replace(config, network=network, loop=loop, start=recipe.start)


def _study(keypoints: KeypointChoice, images: RcnnImages) -> TrainKeypointRcnnConfig:
    """An epoch is what the data set holds; 4500 images, as published, where images are drawn on line or streamed."""
    if images.folder is None:
        return study()
    return study(learnt_images(set_of_target(images.folder, keypoints.target), images.validation))


def _validate(mission: Mission, keypoints: KeypointChoice, images: RcnnImages, side: int) -> Validate | None:
    if not images.validation:
        return None
    if images.folder is None:
        frames = lambda: fresh_frames(mission, images.validation, side)  # noqa: E731
    else:
        dataset = set_of_target(images.folder, keypoints.target)
        frames = lambda: kept_aside(dataset, images.validation)  # noqa: E731
    return mean_e_c(frames, keypoints.points_m, list(keypoints.names))


def _reader_job(images: RcnnImages, keypoints: KeypointChoice) -> Callable[[], Callable[[int], TrainingSample]]:
    """Reads frames of a folder, over and over."""
    place, target = images.data, keypoints.target
    assert place is not None

    def job() -> Callable[[int], TrainingSample]:
        dataset = set_of_target(place, target)
        read = sample_reader(dataset)
        return lambda index: read(index % len(dataset))

    return job
