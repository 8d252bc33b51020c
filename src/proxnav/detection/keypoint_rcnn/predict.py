"""Keypoints from an image by the network in torch."""

import numpy as np
import torch
from jaxtyping import UInt8

from proxnav.detection.keypoint_rcnn.detect import DetectConfig, Detection, Found, RunNetwork, detect
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.geometry.types import Image
from proxnav.records import Keypoints


def predict(network: KeypointRcnn, image: Image, config: DetectConfig | None = None) -> Keypoints:
    """Keypoints of one image, in its corner-origin pixels; `no_target` where no box scores enough."""
    return predict_with_mask(network, image, config).keypoints


def predict_with_mask(network: KeypointRcnn, image: Image, config: DetectConfig | None = None) -> Detection:
    """As `predict`, with the target's pixels when the network has a mask head."""
    size = network.config
    return detect(torch_runner(network), image, size.side, size.n_keypoints, config or DetectConfig())


def torch_runner(network: KeypointRcnn, bfloat16: bool = False) -> RunNetwork:
    """The network in eval mode as a function of one square image; bfloat16 is faster where hardware has it."""
    network.eval()
    device = next(network.parameters()).device

    @torch.inference_mode()
    def run(picture: UInt8[np.ndarray, "side side"]) -> Found:
        with torch.autocast(device.type, torch.bfloat16, enabled=bfloat16):
            found = network({"images": torch.from_numpy(np.ascontiguousarray(picture))[None].to(device)})
        arrays = {name: value[0].double().cpu().numpy() for name, value in found.items()}
        return Found(arrays["boxes"], float(arrays["scores"]), arrays["keypoint_maps"], arrays.get("mask_maps"))

    return run
