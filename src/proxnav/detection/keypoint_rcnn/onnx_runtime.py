"""Keypoint R-CNN without torch: the exported graph under ONNX Runtime."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
from jaxtyping import UInt8

from proxnav.detection.keypoint_rcnn.detect import DetectConfig, Detection, Found, RunNetwork, detect
from proxnav.errors import InputError
from proxnav.geometry.types import Image
from proxnav.records import Keypoints


@dataclass(frozen=True, slots=True)
class OnnxKeypointRcnn:
    """A loaded graph and what its header says."""

    run: RunNetwork
    side: int
    n_keypoints: int
    notes: dict[str, Any]

    def predict(self, image: Image, config: DetectConfig | None = None) -> Keypoints:
        """Keypoints of one image, in its corner-origin pixels; `no_target` where no box scores enough."""
        return self.predict_with_mask(image, config).keypoints

    def predict_with_mask(self, image: Image, config: DetectConfig | None = None) -> Detection:
        """As `predict`, with the target's pixels when the network has a mask head."""
        return detect(self.run, image, self.side, self.n_keypoints, config or DetectConfig())


def load_onnx(path: Path, threads: int = 0) -> OnnxKeypointRcnn:
    """The network of a file written by `export_onnx`, on the accelerator where ONNX Runtime has one."""
    if not path.is_file():
        raise InputError(f"no network at {path}: check the path")
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = threads
    try:
        session = onnxruntime.InferenceSession(str(path), options, providers=onnxruntime.get_available_providers())
    except Exception as error:
        raise InputError(f"{path} is not an ONNX graph that can be run: {error}") from error
    notes = json.loads(session.get_modelmeta().custom_metadata_map.get("proxnav", "{}"))
    if notes.get("detector") != "keypoint-rcnn":
        raise InputError(f"{path} holds a {notes.get('detector', 'foreign')} network, expected keypoint-rcnn")
    names = [output.name for output in session.get_outputs()]

    def run(picture: UInt8[np.ndarray, "side side"]) -> Found:
        outputs: Any = session.run(names, {"image": np.ascontiguousarray(picture)[None]})
        found = {name: value[0].astype(np.float64) for name, value in zip(names, outputs, strict=True)}
        return Found(found["boxes"], float(found["scores"]), found["keypoint_maps"], found.get("mask_maps"))

    return OnnxKeypointRcnn(run, notes["side"], notes["n_keypoints"], notes)
