"""`proxnav train keypoint-rcnn`: the seed study's network, by its recipe or by one for two processor cores."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np

from proxnav.cli.progress import progress
from proxnav.datasets.set.dataset import Dataset
from proxnav.datasets.shards import is_sharded, read_index
from proxnav.detection.keypoint_rcnn.calibrate import fit_calibration
from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.keypoint_rcnn.onnx_export import export_onnx
from proxnav.detection.keypoint_rcnn.predict import predict
from proxnav.detection.keypoint_rcnn.train import TrainKeypointRcnnConfig, study, study_small, train_keypoint_rcnn
from proxnav.detection.keypoint_rcnn.weights import save_network
from proxnav.detection.samples import SampleSource, TrainingSample, shuffled, with_keypoints
from proxnav.detection.shard_stream import streamed
from proxnav.detection.training import Validate
from proxnav.detection.training.ranks import is_first_rank
from proxnav.errors import InputError
from proxnav.estimator import write_model_card
from proxnav.images.tones import grey_8_bit
from proxnav.learning.crops import CropConfig, MixedJob, WholeFrameJob, sample_source
from proxnav.learning.rcnn_validation import fresh_frames, kept_aside, mean_e_c
from proxnav.missions import Mission, load_mission
from proxnav.storage.files import write_json
from proxnav.storage.run_record import run_record
from proxnav.targets.loading import load_target

_CALIBRATION_SEED = 8_000_002


@dataclass(frozen=True)
class TrainRcnnOptions:
    """Trains Keypoint R-CNN into --out (checkpoints, learning curve), then exports it as a model into --out/model."""

    out: Path
    """Folder of the run; the same command resumes it."""
    preset: Literal["study", "study-small"] = "study-small"
    """study: as published, for a GPU; study-small: slim heads and small sides, for two cores."""
    data: Path | None = None
    """Data set to train on, a folder or shards (also s3://...); without it every image is ray-cast fresh."""
    validation: int = 0
    """Frames whose mean E_C chooses the weights: the last of a --data folder, else fresh; 0 takes the last weights."""
    validate_every: int = 0
    """Steps; 0 is an epoch of study, 500 of study-small."""
    patience: int = 0
    """Validations without a better one that end the run; 0: no end."""
    target: str = "space-rider"
    """Name or file of the target, for images drawn on line."""
    subset: str = "six"
    """Named keypoints of the target; empty takes all."""
    side: int = 320
    """study-small: pixels of the square that the network sees."""
    steps: int = 3000
    """study-small: optimiser steps of 16 images."""
    minutes: float = 0.0
    """Stop, resumable, after so long; 0 is no limit."""
    workers: int = 1
    """Processes that draw."""
    repeats: int = 4
    """Times that a drawn image is learnt from."""
    mask: bool = False
    """Train the mask head as well (Mask R-CNN)."""
    devices: int = 1
    """Processes, one for each accelerator; for more than one start the command under torchrun."""
    start: Path | None = None
    """Weights to start from: ImageNet's, or a backbone's."""
    calibration: int = 100
    """Fresh frames on which the covariances are fitted."""
    looks: int = 1
    """2: the model looks again, closer; the study does not."""
    least_median_score: float = 0.6
    """Of the keypoints that the model finds; below it no pose."""
    dry_run: bool = False
    """Only say how long it would take and how much disk it needs."""


def run(options: TrainRcnnOptions) -> None:
    """Entry of `proxnav train keypoint-rcnn`."""
    names, points, indices = _keypoints(options)
    config = _recipe(options, len(names))
    if options.dry_run:
        print(dry_run(options, config, indices))
        return
    source, validate = _source(options), _validation(options, config, points, names)
    write_json(options.out / "config.json", run_record(options), indent=1)
    result = train_keypoint_rcnn(config, with_keypoints(source, indices), options.out, validate)
    if not is_first_rank():
        return
    best = "" if validate is None else f", best mean E_C {result.best_score:.4f}"
    print(f"{result.reason}: {result.steps} steps, {result.samples} images{best}; {result.weights}")
    network = result.model
    assert isinstance(network, KeypointRcnn)
    calibration = _calibrate(network, options, indices)
    folder = options.out / "model"
    notes = config.network.to_json()
    save_network(network, folder / "keypoint-rcnn.safetensors", notes)
    export_onnx(network, folder / "keypoint-rcnn.onnx", notes)
    card = {
        "detector": "keypoint-rcnn",
        "target": options.target,
        "keypoint_names": names,
        "keypoints_m": points.tolist(),
        "settings": {"min_score": 0.5, "looks": options.looks, "calibration": asdict(calibration)},
        "least_median_score": options.least_median_score,
    }
    write_model_card(folder, card)
    print(f"model in {folder}")


def _keypoints(options: TrainRcnnOptions) -> tuple[list[str], np.ndarray, tuple[int, ...]]:
    """(names, points, their places among all keypoints of the samples)."""
    target = load_target(options.target)
    if options.subset and options.subset not in target.subsets:
        raise InputError(f"target {target.name} has no keypoint subset '{options.subset}', only {list(target.subsets)}")
    indices = target.subsets[options.subset] if options.subset else tuple(range(len(target.keypoint_names)))
    return [target.keypoint_names[i] for i in indices], target.keypoints_m[list(indices)], indices


def _recipe(options: TrainRcnnOptions, n_keypoints: int) -> TrainKeypointRcnnConfig:
    config = _study(options) if options.preset == "study" else study_small(options.steps, options.side)
    network = replace(config.network, n_keypoints=n_keypoints, mask=options.mask)
    every = options.validate_every or config.loop.validate_every
    loop = replace(config.loop, minutes=options.minutes, devices=options.devices, patience=options.patience)
    loop = replace(loop, validate_every=every if options.validation else 0)
    return replace(config, network=network, loop=loop, start=options.start, quarter_turns=False)


def _study(options: TrainRcnnOptions) -> TrainKeypointRcnnConfig:
    """An epoch is what the data set holds; 4500 images, as published, where images are drawn on line or streamed."""
    if options.data is None or is_sharded(options.data):
        return study()
    return study(_learnt_images(_dataset(options), options))


def _validation(
    options: TrainRcnnOptions, config: TrainKeypointRcnnConfig, points: np.ndarray, names: list[str]
) -> Validate | None:
    if not options.validation:
        return None
    if options.data is None or is_sharded(options.data):
        return mean_e_c(lambda: fresh_frames(options.target, options.validation, config.network.side), points, names)
    dataset = _dataset(options)
    _learnt_images(dataset, options)
    return mean_e_c(lambda: kept_aside(dataset, options.validation), points, names)


def _learnt_images(dataset: Dataset, options: TrainRcnnOptions) -> int:
    """How many images of the set are learnt from: those that are not kept aside."""
    left = len(dataset) - options.validation
    if left < 1:
        raise InputError(
            f"--validation {options.validation} leaves none of the {len(dataset)} images of {options.data}"
        )
    return left


def dry_run(options: TrainRcnnOptions, config: TrainKeypointRcnnConfig, indices: tuple[int, ...]) -> str:
    """Drawing (or reading) and learning, each measured on a few samples."""
    from proxnav.commands.dry_run import of_training

    loop = config.loop

    def learn(source: SampleSource, folder: Path, steps: int) -> None:
        train_keypoint_rcnn(replace(config, loop=replace(loop, steps=steps)), with_keypoints(source, indices), folder)

    job = _reader_job(options) if options.data is not None else _crops(options)
    batch = loop.batch_size * loop.accumulate
    estimate = of_training(job, learn, loop.steps, batch, options.workers, options.repeats)
    return estimate.text(f"{loop.steps} steps of {batch} images")


def _reader_job(options: TrainRcnnOptions) -> Callable[[], Callable[[int], TrainingSample]]:
    dataset = _dataset(options)
    return lambda: lambda index: _reader(dataset)(index % len(dataset))


def _mission(options: TrainRcnnOptions) -> Mission:
    return replace(load_mission("observation-10-100m"), target=options.target)


def _crops(options: TrainRcnnOptions) -> MixedJob:
    return MixedJob(CropConfig(_mission(options).training_mission, 160, seed=5), options.side)


def _source(options: TrainRcnnOptions) -> SampleSource:
    if options.data is not None and is_sharded(options.data):
        index = read_index(options.data)
        _check_names(index.keypoint_names, options)
        return streamed(index, seed=0)
    if options.data is not None:
        dataset = _dataset(options)
        return shuffled(_reader(dataset), _learnt_images(dataset, options), seed=0)
    return sample_source(_crops(options), options.workers, options.repeats)


def _dataset(options: TrainRcnnOptions) -> Dataset:
    assert options.data is not None
    dataset = Dataset(options.data)
    _check_names(dataset.keypoint_names, options)
    return dataset


def _check_names(names: tuple[str, ...], options: TrainRcnnOptions) -> None:
    if names != load_target(options.target).keypoint_names:
        raise InputError(
            f"{options.data} labels other keypoints than target {options.target} has; name the set's --target"
        )


def _reader(dataset: Dataset) -> Callable[[int], TrainingSample]:
    def read(index: int) -> TrainingSample:
        label = dataset.labels[index]
        return TrainingSample(
            grey_8_bit(dataset.image(index)), label.keypoints_px, label.visibility, label.box_xyxy, dataset.mask(index)
        )

    return read


def _calibrate(network: KeypointRcnn, options: TrainRcnnOptions, indices: tuple[int, ...]) -> Calibration:
    """Scale and floor of the covariances, from fresh frames in the size that the network sees."""
    frames = CropConfig(_mission(options), options.side, seed=_CALIBRATION_SEED)
    make, errors, spreads = WholeFrameJob(frames, empty_share=0.0)(), [], []
    with progress("calibrate", options.calibration) as done:
        for index in range(options.calibration):
            sample = make(index)
            found = predict(network, sample.image, DetectConfig(calibration=Calibration(scale=1.0, floor_px=0.0)))
            errors.append(found.pixels - sample.keypoints_px[list(indices)])
            spreads.append(found.covariances_px2)
            done()
    return fit_calibration(np.concatenate(errors), np.concatenate(spreads))
