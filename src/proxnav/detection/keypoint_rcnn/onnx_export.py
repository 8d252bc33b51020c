"""The trained network as one ONNX graph: square image in; best box, its score and keypoint maps out."""

import json
import warnings
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import torch
from onnx import helper, numpy_helper
from torch import Tensor, nn

from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.keypoint_rcnn.weights import DETECTOR, LEAST_IN_8_BITS
from proxnav.detection.training.files import write_atomically

OPSET = 17


class _Graph(nn.Module):
    """The network with tensors instead of dictionaries at its ends."""

    def __init__(self, network: KeypointRcnn) -> None:
        super().__init__()
        self.network = network

    def forward(self, image: Tensor) -> tuple[Tensor, ...]:
        found = self.network.best(*self.network.features(image))
        return tuple(found.values())


def export_onnx(network: KeypointRcnn, path: Path, notes: Mapping[str, Any] | None = None, bits: int = 8) -> None:
    """Writes the network to `path`; `bits` 8 stores large weights as int8 with scales, 32 as they are.

    The graph computes in float32 either way: the runtime multiplies the weights out once, when it loads.
    """
    network = network.cpu().eval()
    names = ["boxes", "scores", "keypoint_maps"] + (["mask_maps"] if network.config.mask else [])
    image = torch.zeros(1, network.config.side, network.config.side, dtype=torch.uint8)

    def write(temporary: Path) -> None:
        with warnings.catch_warnings(), torch.no_grad():
            # Tracing fixes the sizes of this one square, which is what is wanted; and the exporter is the one that
            # knows torchvision's operators without a further dependency.
            warnings.simplefilter("ignore")
            torch.onnx.export(
                _Graph(network).eval(), (image,), str(temporary), input_names=["image"], output_names=names,
                opset_version=OPSET, dynamo=False,
            )  # fmt: skip
        model = onnx.load(temporary)
        if bits == 8:
            store_in_8_bits(model)
        header = {"detector": DETECTOR} | network.config.to_json() | dict(notes or {})
        helper.set_model_props(model, {"proxnav": json.dumps(header, sort_keys=True)})
        onnx.save(model, temporary)

    write_atomically(path, write)


def store_in_8_bits(model: onnx.ModelProto) -> None:
    """Large weights as int8 times a scale per first index, multiplied out by the graph itself."""
    graph = model.graph
    large = [w for w in graph.initializer if w.data_type == onnx.TensorProto.FLOAT and len(w.dims) >= 2]
    nodes = []
    for weight in (w for w in large if int(np.prod(w.dims)) >= LEAST_IN_8_BITS):
        values, name = numpy_helper.to_array(weight), weight.name
        scale = np.abs(values.reshape(len(values), -1)).max(axis=1) / 127.0
        scale = np.maximum(scale, 1e-12).astype(np.float32).reshape(-1, *[1] * (values.ndim - 1))
        steps = np.clip(np.round(values / scale), -127, 127).astype(np.int8)
        graph.initializer.remove(weight)
        graph.initializer.append(numpy_helper.from_array(steps, f"{name}.int8"))
        graph.initializer.append(numpy_helper.from_array(scale, f"{name}.scale"))
        nodes.append(helper.make_node("Cast", [f"{name}.int8"], [f"{name}.float"], to=onnx.TensorProto.FLOAT))
        nodes.append(helper.make_node("Mul", [f"{name}.float", f"{name}.scale"], [name]))
    rest = list(graph.node)
    del graph.node[:]
    graph.node.extend(nodes + rest)
