"""From trained weights to the two files that run without torch: a graph, and the weights that it points into.

The weights are one safetensors file in half precision; the ONNX graph names ranges of that very file as its external
data and casts them to float32: the weights are stored once, torch and every ONNX runtime read the same bytes.
"""

import json
import struct
import warnings
from pathlib import Path
from typing import Any

import onnx
import torch
from onnx import TensorProto, helper
from safetensors.torch import save_file
from torch import Tensor, nn

from proxnav.detection.heatmap.decode import covariances, decode, sample_spread
from proxnav.detection.heatmap.pyramid import STRIDE

OPSET = 17


class ReadKeypoints(nn.Module):
    """Crops (b, h, w) uint8 to points (b, n, 2) [px], scores, covariances (b, n, 2, 2) [px^2], shown (b,)."""

    OUTPUTS = ("points", "scores", "covariances", "shown")

    def __init__(self, net: nn.Module) -> None:
        super().__init__()
        self.net = net

    def forward(self, crops: Tensor) -> tuple[Tensor, Tensor, Tensor, Tensor]:
        maps = self.net(crops[:, None].float() / 255.0)
        points, scores = decode(maps.logits)
        covariance = covariances(sample_spread(maps.spread, points))
        shown = maps.mask.float().sigmoid().mean(dim=(1, 2, 3))
        return points * STRIDE, scores, covariance * STRIDE**2, shown


class FindTarget(nn.Module):
    """Frames (b, h, w) uint8 to probabilities (b, h/4, w/4) of each cell showing the target."""

    def __init__(self, net: nn.Module) -> None:
        super().__init__()
        self.net = net

    def forward(self, frames: Tensor) -> Tensor:
        return self.net(frames[:, None].float() / 255.0).sigmoid()[:, 0]


def export(model: nn.Module, outputs: tuple[str, ...], side: int, folder: Path, name: str) -> None:
    """Writes `name.safetensors` (half precision) and `name.onnx`, whose weights lie in the former."""
    folder.mkdir(parents=True, exist_ok=True)
    graph_path, weights_path = folder / f"{name}.onnx", folder / f"{name}.safetensors"
    model = model.eval().float()
    half = {key: value.half() if value.is_floating_point() else value for key, value in model.state_dict().items()}
    model.load_state_dict({key: value.float() if value.is_floating_point() else value for key, value in half.items()})
    save_file({key: value.contiguous() for key, value in half.items()}, weights_path)
    _trace(model, outputs, side, graph_path)
    graph = onnx.load(str(graph_path))
    _point_into(graph, weights_path)
    onnx.save(graph, str(graph_path))


def _trace(model: nn.Module, outputs: tuple[str, ...], side: int, path: Path) -> None:
    with warnings.catch_warnings():
        # The newer exporter needs onnxscript and renames the weights that `_point_into` looks for.
        warnings.simplefilter("ignore")
        torch.onnx.export(
            model,
            (torch.zeros(1, side, side, dtype=torch.uint8),),
            str(path),
            input_names=["images"],
            output_names=list(outputs),
            dynamic_axes={key: {0: "batch"} for key in ("images", *outputs)},
            opset_version=OPSET,
            do_constant_folding=False,
            dynamo=False,
        )


def _point_into(model: onnx.ModelProto, weights: Path) -> None:
    """Replaces the initialisers that the weights file holds by casts of ranges of that file."""
    ranges = _ranges(weights)
    casts = []
    for tensor in model.graph.initializer:
        if tensor.data_type != TensorProto.FLOAT or tensor.name not in ranges:
            continue
        name, (start, length) = tensor.name, ranges[tensor.name]
        tensor.ClearField("raw_data")
        tensor.ClearField("float_data")
        tensor.data_type, tensor.name = TensorProto.FLOAT16, f"{name}.half"
        tensor.data_location = TensorProto.EXTERNAL
        del tensor.external_data[:]
        for key, value in (("location", weights.name), ("offset", str(start)), ("length", str(length))):
            tensor.external_data.add(key=key, value=value)
        casts.append(helper.make_node("Cast", [tensor.name], [name], to=TensorProto.FLOAT, name=f"{name}.cast"))
    nodes = list(model.graph.node)
    del model.graph.node[:]
    model.graph.node.extend([*casts, *nodes])


def _ranges(path: Path) -> dict[str, tuple[int, int]]:
    """Name to (offset in the file, length) of each tensor of a safetensors file (its header is 8 bytes + JSON)."""
    with path.open("rb") as file:
        (size,) = struct.unpack("<Q", file.read(8))
        header: dict[str, Any] = json.loads(file.read(size))
    spans = {name: entry["data_offsets"] for name, entry in header.items() if name != "__metadata__"}
    return {name: (8 + size + begin, end - begin) for name, (begin, end) in spans.items()}
