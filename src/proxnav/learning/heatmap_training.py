"""Set-ups of the crop network and of the finder: every image is drawn fresh while the network learns."""

from dataclasses import replace

import numpy as np
from torch import nn

from proxnav.detection.heatmap.augment import Turns
from proxnav.detection.heatmap.train import (
    TrainFinderConfig,
    TrainHeatmapConfig,
    keypoint_errors,
    train_finder,
    train_heatmap,
)
from proxnav.detection.samples import TrainingSample
from proxnav.detection.training.learner import Validate
from proxnav.errors import InputError
from proxnav.learning.crops import CropConfig, CropJob, WholeFrameJob
from proxnav.learning.drawn_stream import sample_source
from proxnav.learning.training import Training
from proxnav.missions import Mission
from proxnav.targets.loading import load_target

_VALIDATION_SEED = 7_000_001


def crop_training(
    config: TrainHeatmapConfig, mission: Mission, side: int, seed: int, workers: int, repeats: int, validation: int
) -> Training:
    """The crop network on ray-cast crops that never repeat, scored on `validation` crops that are kept aside."""
    _check_side(side)
    crops = CropConfig(mission.training_mission, side, seed)
    n_keypoints = len(load_target(mission.target).keypoint_names)
    kept_aside = CropConfig(mission, side, _VALIDATION_SEED)
    return Training(
        learn=lambda loop, source, out, validate: train_heatmap(
            replace(config, loop=loop), n_keypoints, source, out, validate, _turns(mission)
        ),
        loop=config.loop,
        draw=CropJob(crops),
        source=sample_source(CropJob(crops), workers, repeats),
        validate=median_error(kept_aside, validation),
        workers=workers,
        repeats=repeats,
    )


def finder_training(
    config: TrainFinderConfig, mission: Mission, side: int, seed: int, workers: int, repeats: int
) -> Training:
    """The finder on ray-cast frames that never repeat."""
    _check_side(side)
    frames = WholeFrameJob(CropConfig(mission.training_mission, side, seed))
    return Training(
        learn=lambda loop, source, out, validate: train_finder(
            replace(config, loop=loop), source, out, validate, _turns(mission)
        ),
        loop=config.loop,
        draw=frames,
        source=sample_source(frames, workers, repeats),
        validate=None,
        workers=workers,
        repeats=repeats,
    )


def _turns(mission: Mission) -> Turns:
    """Any turn of a crop is a view of the mission where any roll of the camera is."""
    view = mission.training_mission.view
    return "any" if "any" in (view.roll_deg, view.attitude) else "small"


def _check_side(side: int) -> None:
    if side < 32 or side % 32:
        raise InputError(f"--side {side}: the network needs a multiple of 32 px")


def median_error(crops: CropConfig, count: int) -> Validate:
    """Mean over `count` crops of the median keypoint error [px of the crop]; the crops are drawn once."""
    kept: list[TrainingSample] = []

    def validate(net: nn.Module) -> float:
        if not kept:
            make = CropJob(crops)()
            kept.extend(make(index) for index in range(count))
        return float(np.mean(np.nanmedian(keypoint_errors(net, kept), axis=1)))

    return validate
