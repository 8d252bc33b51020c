"""python tools/average_weights.py OUT SHARE:WEIGHTS [SHARE:WEIGHTS ...]: weighted mean of networks of one lineage.

Trainings that started from one another lie in one basin, where the mean of two is often better than either
(M. Wortsman et al., "Model soups", ICML 2022).
"""

import sys
from pathlib import Path

import torch
from safetensors.torch import load_file, save_file


def read(path: str) -> dict[str, torch.Tensor]:
    """Tensors as float32, under the names of the network."""
    tensors = {name.removeprefix("net."): value for name, value in load_file(Path(path)).items()}
    return {name: value.float() if value.is_floating_point() else value for name, value in tensors.items()}


def main(out: str, *terms: str) -> None:
    """Writes the mean; shares are scaled to add up to 1, integers (counters) come from the last term."""
    parts = [(float(share), read(path)) for share, path in (term.split(":", 1) for term in terms)]
    total, last = sum(share for share, _ in parts), parts[-1][1]
    mean = {
        name: torch.stack([share / total * tensors[name] for share, tensors in parts]).sum(0)
        for name, value in last.items()
        if value.is_floating_point()
    }
    save_file({name: value.contiguous() for name, value in (last | mean).items()}, out)


if __name__ == "__main__":
    main(*sys.argv[1:])
