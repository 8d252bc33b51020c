"""A trained Keypoint R-CNN as a model folder that runs without torch, its covariances calibrated."""

from pathlib import Path

import numpy as np
from torch import nn

from proxnav.cluster.progress import Progress, silent
from proxnav.detection.keypoint_rcnn.calibrate import fit_calibration
from proxnav.detection.keypoint_rcnn.decode import Calibration
from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.keypoint_rcnn.onnx_export import export_onnx
from proxnav.detection.keypoint_rcnn.predict import predict
from proxnav.detection.keypoint_rcnn.weights import save_network
from proxnav.learning.crops import CropConfig, WholeFrameJob
from proxnav.learning.rcnn_training import KeypointChoice
from proxnav.missions import MISSION, Mission, write_mission
from proxnav.models.card import ModelCard, write_card

_SEED = 8_000_002


def export_rcnn_model(
    network: nn.Module, mission: Mission, keypoints: KeypointChoice, folder: Path, side: int, frames: int, passes: int,
    least: float, progress: Progress = silent,
) -> None:  # fmt: skip
    """Writes the network and its model.json, covariances calibrated on `frames` fresh frames of `side` px.

    `least` is the median score of the keypoints found below which there is no pose.
    """
    assert isinstance(network, KeypointRcnn)
    settings = DetectConfig(passes=passes, calibration=_calibrated(network, mission, keypoints, side, frames, progress))
    notes = network.config.to_json()
    save_network(network, folder / "keypoint-rcnn.safetensors", notes)
    export_onnx(network, folder / "keypoint-rcnn.onnx", notes)
    write_card(folder, ModelCard(keypoints.target, keypoints.names, keypoints.points_m, settings, least))
    write_mission(folder / MISSION, mission)


def _calibrated(
    network: KeypointRcnn, mission: Mission, keypoints: KeypointChoice, side: int, frames: int, progress: Progress
) -> Calibration:
    """Scale and floor of the covariances, from fresh frames in the size that the network sees."""
    config = CropConfig(mission, side, _SEED)
    make, errors, spreads = WholeFrameJob(config, empty_share=0.0)(), [], []
    plain = DetectConfig(calibration=Calibration(scale=1.0, floor_px=0.0))
    with progress("calibrate", frames) as done:
        for index in range(frames):
            sample = make(index)
            found = predict(network, sample.image, plain)
            errors.append(found.pixels - sample.keypoints_px[list(keypoints.indices)])
            spreads.append(found.covariances_px2)
            done()
    return fit_calibration(np.concatenate(errors), np.concatenate(spreads))
