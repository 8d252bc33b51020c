"""Several processes that train one network: how they start, and what they must agree on.

Under torchrun each process is a rank. Gradients are averaged, so that N ranks of batch B step as one process of batch
N B does; all else that decides when to stop is agreed upon, because a rank that leaves alone leaves the others waiting.
"""

import logging
import os
from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
from lightning_fabric import Fabric
from torch.distributed import PrefixStore, TCPStore, init_process_group  # pyright: ignore[reportPrivateImportUsage]

from proxnav.detection.training.config import LoopConfig
from proxnav.detection.training.precision import best_precision
from proxnav.errors import InputError

_OF_ONE_RANK = ("rate", "images_per_s", "waiting")


def launched(config: LoopConfig) -> Fabric:
    """This process as a rank of the training, connected to the others where there are any."""
    ranks = int(os.environ.get("WORLD_SIZE", "1"))
    if config.devices > 1 and "TORCHELASTIC_RUN_ID" not in os.environ:
        raise InputError(
            f"{config.devices} devices need one process each: torchrun --nproc-per-node {config.devices} "
            "-m proxnav.cli.main train ..."
        )
    nodes = max(1, ranks // config.devices)
    if ranks != nodes * config.devices:
        raise InputError(f"torchrun started {ranks} processes, the options name {config.devices} devices a machine")
    # A step may leave out a head (no target in any image): its weights then have no gradient in that rank.
    strategy = "ddp_find_unused_parameters_true" if ranks > 1 else "auto"
    precision = best_precision(config.precision)
    logging.getLogger("lightning_fabric").setLevel(logging.WARNING)  # it prints the number format at every start
    fabric = Fabric(
        accelerator=config.accelerator, strategy=strategy, devices=config.devices, num_nodes=nodes, precision=precision
    )
    _meet_again(ranks)
    fabric.launch()
    return fabric


def _meet_again(ranks: int) -> None:
    """Ranks that torchrun started again meet under a name of their own.

    torchrun keeps one store over all starts, in which the addresses of ranks that died still stand: without this a new
    rank may wait for a dead one for ever. Fabric takes over a group that it finds.
    """
    attempt = os.environ.get("TORCHELASTIC_RESTART_COUNT", "0")
    if ranks == 1 or attempt == "0" or os.environ.get("TORCHELASTIC_USE_AGENT_STORE") != "True":
        return
    host, port = os.environ["MASTER_ADDR"], int(os.environ["MASTER_PORT"])
    store = PrefixStore(f"attempt-{attempt}", TCPStore(host, port, ranks, is_master=False))
    init_process_group(store=store, rank=int(os.environ["RANK"]), world_size=ranks)


def is_first_rank() -> bool:
    """Whether this process writes what a training leaves; true where there is only one."""
    return os.environ.get("RANK", "0") == "0"


def any_rank(fabric: Fabric, flag: bool) -> bool:
    """Whether the flag is up in any rank: a signal may reach one of them alone."""
    if fabric.world_size == 1:
        return flag
    flags: Any = fabric.all_reduce(torch.tensor(float(flag), device=fabric.device), reduce_op="sum")
    return bool(flags > 0.0)


def mean_over_ranks(fabric: Fabric, row: Mapping[str, float]) -> dict[str, float]:
    """A row of the learning curve with its loss terms averaged over the ranks."""
    if fabric.world_size == 1:
        return dict(row)
    names = sorted(name for name in row if name not in _OF_ONE_RANK)
    values = torch.tensor([row[name] for name in names], dtype=torch.float64, device=fabric.device)
    means: Any = fabric.all_reduce(values, reduce_op="mean")
    return dict(row) | dict(zip(names, means.tolist(), strict=True))


def reseed(fabric: Fabric, seed: int, step: int) -> None:
    """With several ranks, torch's generator depends on (seed, step, rank): a checkpoint holds the first's alone."""
    if fabric.world_size > 1:
        (state,) = np.random.SeedSequence([seed, step, fabric.global_rank]).generate_state(1, np.uint64)
        torch.manual_seed(int(state >> np.uint64(1)))
