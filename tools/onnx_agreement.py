"""How far the exported Keypoint R-CNN is from torch on whole frames, keypoint by keypoint.

    python tools/onnx_agreement.py runs/rcnn/model --weights runs/rcnn/weights.safetensors

Frames are ray-cast ones of `observation-10-100m` that no training sees. Two differences: the graph against the network
of the model folder's own 8 bit weights (the export alone), and against the float32 weights of the training (the export
and the rounding).
"""

import argparse
from pathlib import Path

import numpy as np

from proxnav.detection.keypoint_rcnn.detect import DetectConfig
from proxnav.detection.keypoint_rcnn.onnx_runtime import load_onnx
from proxnav.detection.keypoint_rcnn.predict import predict
from proxnav.detection.keypoint_rcnn.weights import load_network
from proxnav.learning.rcnn_validation import fresh_frames
from proxnav.missions import load_mission


def main() -> None:
    """Prints median, 95th percentile and most of the distances [px of the full image]."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("model", type=Path)
    parser.add_argument("--weights", type=Path, help="float32 weights of the training")
    parser.add_argument("--frames", type=int, default=50)
    options = parser.parse_args()
    exported = load_onnx(options.model / "keypoint-rcnn.onnx", 1)
    rows = {"8 bit weights, torch": load_network(options.model / "keypoint-rcnn.safetensors")[0]}
    if options.weights is not None:
        rows["float32 weights, torch"] = load_network(options.weights)[0]
    images = [frame.image for frame in fresh_frames(load_mission("observation-10-100m"), options.frames, 512)]
    config = DetectConfig(min_score=0.0)
    points = np.array([exported.predict(image, config).pixels for image in images])
    for name, network in rows.items():
        away = np.linalg.norm(points - np.array([predict(network, image, config).pixels for image in images]), axis=-1)
        median, high, most = np.percentile(away, [50.0, 95.0, 100.0])
        print(f"{name}: median {median:.4f} px, 95 % {high:.4f} px, most {most:.4f} px over {away.size} keypoints")


if __name__ == "__main__":
    main()
