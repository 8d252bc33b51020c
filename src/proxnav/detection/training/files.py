"""Files that are either the old version or the new one, never half of it."""

import json
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import torch
from safetensors.torch import save_file

from proxnav.errors import InputError


def write_atomically(path: Path, write: Callable[[Path], object]) -> None:
    """Calls `write` with a temporary name beside `path`, then renames it: readers see the old file or the new."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}.part")
    try:
        write(temporary)
        with temporary.open("rb") as file:
            os.fsync(file.fileno())
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


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


def save_weights(path: Path, state: Mapping[str, torch.Tensor], notes: Mapping[str, Any]) -> None:
    """Weights as safetensors, with `notes` as JSON in the header."""
    tensors = {name: tensor.detach().cpu().contiguous().clone() for name, tensor in state.items()}
    header = {"proxnav": json.dumps(dict(notes), sort_keys=True)}
    write_atomically(path, lambda temporary: save_file(tensors, temporary, header))
