"""`proxnav train keypoint-rcnn`: the seed study's network, by its recipe or by one for two processor cores."""

from collections.abc import Callable
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Literal

import numpy as np
import tyro

from proxnav import presets
from proxnav.commands.progress import progress
from proxnav.crops import CropConfig, MixedJob, WholeFrameJob, sample_source
from proxnav.datasets.dataset import Dataset
from proxnav.datasets.files import write_json
from proxnav.datasets.run_record import run_record
from proxnav.detection.images import grey_8_bit
from proxnav.detection.keypoint_rcnn.calibrate import fit_calibration
from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.keypoint_rcnn.onnx_export import export_onnx
from proxnav.detection.keypoint_rcnn.predict import predict
from proxnav.detection.keypoint_rcnn.train import TrainKeypointRcnnConfig, study, study_small, train_keypoint_rcnn
from proxnav.detection.keypoint_rcnn.weights import save_network
from proxnav.detection.samples import SampleSource, TrainingSample, shuffled, with_keypoints
from proxnav.errors import InputError
from proxnav.estimator import write_model_card
from proxnav.targets.loading import load_target

_CALIBRATION_SEED = 8_000_002


@dataclass(frozen=True)
class TrainRcnnOptions:
    """Trains Keypoint R-CNN into --out (checkpoints, learning curve), then exports it as a model into --out/model."""

    out: Path
    """Folder of the run; the same command resumes it."""
    recipe: Literal["study", "study-small"] = "study-small"
    """study: as published, for a GPU; study-small: slim heads and small sides, for two cores."""
    data: Path | None = None
    """Data set to train on; without it every image is ray-cast fresh."""
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
    start: Path | None = None
    """Weights to start from: ImageNet's, or a backbone's."""
    calibration: int = 100
    """Fresh frames on which the covariances are fitted."""


def main(argv: list[str]) -> None:
    """Entry of `proxnav train keypoint-rcnn`."""
    options = tyro.cli(TrainRcnnOptions, args=argv, prog="proxnav train keypoint-rcnn")
    names, points, indices = _keypoints(options)
    write_json(options.out / "config.json", run_record(options), indent=1)
    config = _recipe(options, len(names))
    result = train_keypoint_rcnn(config, with_keypoints(_source(options), indices), options.out)
    print(f"{result.reason}: {result.steps} steps, {result.samples} images; {result.weights}")
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
        "settings": {"min_score": 0.5, "looks": 1, "calibration": asdict(calibration)},
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
    config = study() if options.recipe == "study" else study_small(options.steps, options.side)
    network = replace(config.network, n_keypoints=n_keypoints, mask=options.mask)
    loop = replace(config.loop, minutes=options.minutes, validate_every=0)
    return replace(config, network=network, loop=loop, start=options.start, quarter_turns=False)


def _source(options: TrainRcnnOptions) -> SampleSource:
    if options.data is not None:
        dataset = Dataset(options.data)
        if dataset.keypoint_names != load_target(options.target).keypoint_names:
            raise InputError(
                f"{options.data} labels other keypoints than target {options.target} has; name the set's --target"
            )
        return shuffled(_reader(dataset), len(dataset), seed=0)
    job = MixedJob(CropConfig(options.target, 160, scenes=presets.TRAINING, seed=5), options.side)
    return sample_source(job, options.workers, options.repeats)


def _reader(dataset: Dataset) -> Callable[[int], TrainingSample]:
    def read(index: int) -> TrainingSample:
        label = dataset.labels[index]
        return TrainingSample(
            grey_8_bit(dataset.image(index)), label.keypoints_px, label.visibility, label.box_xyxy, dataset.mask(index)
        )

    return read


def _calibrate(network: KeypointRcnn, options: TrainRcnnOptions, indices: tuple[int, ...]) -> Calibration:
    """Scale and floor of the covariances, from fresh frames in the size that the network sees."""
    frames = CropConfig(options.target, options.side, scenes=presets.OBSERVATION, seed=_CALIBRATION_SEED)
    make, errors, spreads = WholeFrameJob(frames, empty_share=0.0)(), [], []
    with progress("calibrate", options.calibration) as done:
        for index in range(options.calibration):
            sample = make(index)
            found = predict(network, sample.image, DetectConfig(calibration=Calibration(scale=1.0, floor_px=0.0)))
            errors.append(found.pixels - sample.keypoints_px[list(indices)])
            spreads.append(found.covariances_px2)
            done()
    return fit_calibration(np.concatenate(errors), np.concatenate(spreads))
