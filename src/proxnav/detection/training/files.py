"""Files that are either the old version or the new one, never half of it."""

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors import SafetensorError
from safetensors.torch import load_file, save_file
from torch import nn

from proxnav.errors import InputError
from proxnav.storage.files import cannot_write, replacing


def write_atomically(path: Path, write: Callable[[Path], object]) -> None:
    """Calls `write` with a file beside `path` that then replaces it, also when the power fails.

    InputError where there is no room, or no leave to write.
    """
    try:
        with replacing(path) as part:
            write(part)
            with part.open("rb") as file:
                os.fsync(file.fileno())
    except OSError as error:
        raise cannot_write(path, error) from None
    except (RuntimeError, SafetensorError) as error:  # what torch and safetensors make of a full disk
        raise InputError(
            f"{path}: cannot be written ({' '.join(str(error).split())[:160]}); is the disk full? Make room, the same "
            "command resumes"
        ) from None


def save_checkpoint(path: Path, content: Mapping[str, Any]) -> None:
    """Tensors and plain Python values to `path`."""
    write_atomically(path, lambda temporary: torch.save(dict(content), temporary))


def load_checkpoint(path: Path) -> dict[str, Any]:
    """Inverse of `save_checkpoint`; nothing in the file is executed. InputError when it cannot be read."""
    try:
        return torch.load(path, map_location="cpu", weights_only=True)
    except Exception as error:
        raise InputError(
            f"{path} is not a readable checkpoint ({type(error).__name__}): delete it to start this run afresh"
        ) from error


def load_fitting(net: nn.Module, path: Path) -> int:
    """Copies those weights that have a network's names and shapes, its trunk for one; how many there were.

    InputError where the file is absent or damaged, or nothing in it fits.
    """
    own, state = net.state_dict(), _read_weights(path)
    fitting = {name: value for name, value in state.items() if name in own and own[name].shape == value.shape}
    if not fitting:
        raise InputError(f"{path}: weights of another kind of network; give those of the same detector")
    net.load_state_dict(own | fitting)
    return len(fitting)


def load_weights(net: nn.Module, path: Path) -> None:
    """Copies the weights of `save_weights`, or of an exported model (names begin with `net.`), into a network.

    InputError where the file is absent, damaged, or of another network.
    """
    state, own = _read_weights(path), net.state_dict()
    foreign = sorted(own.keys() ^ state.keys()) or [name for name in own if own[name].shape != state[name].shape]
    if foreign:
        raise InputError(
            f"{path}: weights of another network, {foreign[0]} does not fit; give its keypoints, trunk and width"
        )
    net.load_state_dict(state)


def save_weights(path: Path, state: Mapping[str, torch.Tensor], notes: Mapping[str, Any]) -> None:
    """Weights as safetensors, with `notes` as JSON in the header."""
    tensors = {name: tensor.detach().cpu().contiguous().clone() for name, tensor in state.items()}
    header = {"proxnav": json.dumps(dict(notes), sort_keys=True)}
    write_atomically(path, lambda temporary: save_file(tensors, temporary, header))


def _read_weights(path: Path) -> dict[str, torch.Tensor]:
    try:
        state = load_file(path)
    except (OSError, SafetensorError) as error:
        raise InputError(f"{path}: no readable safetensors weights ({error}); check the path") from None
    return {name.removeprefix("net."): value for name, value in state.items()}
