"""Weights from and to files: where a training starts, and the small file that is kept."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors import safe_open
from safetensors.torch import load_file
from torch import Tensor

from proxnav.detection.keypoint_rcnn.config import NetworkConfig
from proxnav.detection.keypoint_rcnn.network import KeypointRcnn
from proxnav.detection.training.files import save_weights
from proxnav.errors import InputError

DETECTOR = "keypoint-rcnn"
SCALE = ".scale"
LEAST_IN_8_BITS = 4096
"""Tensors with fewer values stay as they are."""


def start_from(network: KeypointRcnn, path: Path) -> int:
    """Copies what fits by name and shape, returns how many tensors did: the whole network, a backbone or ImageNet's.

    Colour filters of a first layer are added up: the network sees grey.
    """
    given, own = read_state(path), network.state_dict()
    prefixes = ("", "parts.", "parts.backbone.", "parts.backbone.body.")
    matched = {}
    for prefix in prefixes:
        named = {prefix + name: _to_grey(prefix + name, value, own) for name, value in given.items()}
        fits = {name: value for name, value in named.items() if name in own and own[name].shape == value.shape}
        matched = max(matched, fits, key=len)
    if len(matched) < 20:
        raise InputError(f"{path} holds no weights of a ResNet-{network.config.depth}: {len(matched)} tensors fit")
    network.load_state_dict(matched, strict=False)
    return len(matched)


def _to_grey(name: str, value: Tensor, own: Mapping[str, Tensor]) -> Tensor:
    first = name in own and value.ndim == 4 and own[name].shape[1] == 1 and value.shape[1] == 3
    return value.sum(dim=1, keepdim=True) if first else value


def read_state(path: Path) -> dict[str, Tensor]:
    """Tensors by name of a safetensors file or a torch state dict; nothing in the file is executed."""
    if not path.is_file():
        raise InputError(f"no weights at {path}: check the path")
    try:
        if path.suffix == ".safetensors":
            return unpacked(load_file(path))
        state = torch.load(path, map_location="cpu", weights_only=True)
        if not isinstance(state, dict) or not all(isinstance(value, Tensor) for value in state.values()):
            raise ValueError("it holds other things than tensors by name")
        return state
    except Exception as error:
        raise InputError(f"{path} is neither safetensors nor a torch state dict of plain tensors: {error}") from error


def save_network(network: KeypointRcnn, path: Path, notes: Mapping[str, Any] | None = None) -> None:
    """The network in 8 bits a weight with its dimensions in the header: about a quarter of its size in float32."""
    save_weights(
        path, packed(network.state_dict()), {"detector": DETECTOR} | network.config.to_json() | dict(notes or {})
    )


def load_network(path: Path) -> tuple[KeypointRcnn, dict[str, Any]]:
    """A network in eval mode and the header's notes, from `save_network` or a training run's `weights.safetensors`."""
    state = read_state(path)
    with safe_open(path, framework="pt") as file:
        notes = json.loads((file.metadata() or {}).get("proxnav", "{}"))
    if notes.get("detector") != DETECTOR:
        raise InputError(f"{path} holds a {notes.get('detector', 'foreign')} network, expected {DETECTOR}")
    network = KeypointRcnn(NetworkConfig.from_json(notes))
    network.load_state_dict(state)
    return network.eval(), notes


def packed(state: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Large tensors as int8 with one scale per first index (symmetric, nearest); the others unchanged."""
    small: dict[str, Tensor] = {}
    for name, value in state.items():
        if value.ndim < 2 or value.numel() < LEAST_IN_8_BITS:
            small[name] = value
            continue
        scale = (value.flatten(1).abs().amax(dim=1) / 127.0).clamp(min=1e-12)
        small[name] = (value / _over(scale, value)).round().clamp(-127, 127).to(torch.int8)
        small[name + SCALE] = scale
    return small


def unpacked(state: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """Inverse of `packed`, up to rounding."""
    return {
        name: value.float() * _over(state[name + SCALE], value) if value.dtype == torch.int8 else value
        for name, value in state.items()
        if not name.endswith(SCALE)
    }


def _over(scale: Tensor, value: Tensor) -> Tensor:
    return scale.reshape(-1, *[1] * (value.ndim - 1))
