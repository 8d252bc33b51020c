"""Two processes train as one does with twice the batch, and a rank that dies costs nothing but time."""

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from safetensors.torch import load_file
from tests.detection.test_training import CONFIG, learner, source

from proxnav.detection.training.curve import read_rows
from proxnav.detection.training.loop import train
from proxnav.errors import InputError

JOB = Path(__file__).with_name("rank_job.py")
SRC = Path(__file__).parents[2] / "src"
pytestmark = pytest.mark.slow


def run(out: Path, ranks: int, batch: int, *words: str) -> Path:
    """A training of `ranks` processes on the loopback; the folder of the run."""
    out.mkdir()
    launcher = [sys.executable, "-m", "torch.distributed.run", "--nproc-per-node", str(ranks), "--max-restarts", "1"]
    place = ["--rdzv-backend", "c10d", "--rdzv-endpoint", "127.0.0.1:0", "--local-addr", "127.0.0.1"]
    command = [*launcher, *place] if ranks > 1 else [sys.executable]
    environment = os.environ | {"OMP_NUM_THREADS": "1", "GLOO_SOCKET_IFNAME": "lo", "PYTHONPATH": str(SRC)}
    done = subprocess.run(
        [*command, str(JOB), str(out), str(batch), *words], env=environment, capture_output=True, timeout=300
    )
    assert done.returncode == 0, done.stderr.decode()[-3000:]
    return out


def losses(folder: Path) -> np.ndarray:
    return np.array([float(row["loss"]) for row in read_rows(folder / "curve.csv")])


def test_two_processes_learn_as_one_with_twice_the_batch(tmp_path: Path) -> None:
    """The same samples, summed in another order: only rounding differs, over 24 steps with momentum."""
    one, two = run(tmp_path / "one", 1, 6, "plain"), run(tmp_path / "two", 2, 3, "plain")
    assert len(losses(one)) == 12
    assert losses(one)[-1] < 0.6 * losses(one)[0]
    np.testing.assert_allclose(losses(two), losses(one), rtol=2e-4)
    a, b = load_file(one / "weights.safetensors"), load_file(two / "weights.safetensors")
    for name, value in a.items():
        torch.testing.assert_close(b[name], value, rtol=1e-3, atol=1e-5)


def test_a_rank_that_dies_is_started_again_and_the_run_ends_as_if_it_had_not(tmp_path: Path) -> None:
    whole = run(tmp_path / "whole", 2, 3, "dropout")
    killed = run(tmp_path / "killed", 2, 3, "dropout", "dies")
    assert (killed / "died").exists()
    a, b = load_file(whole / "weights.safetensors"), load_file(killed / "weights.safetensors")
    for name, value in a.items():
        assert torch.equal(b[name], value), name
    assert [row["step"] for row in read_rows(killed / "curve.csv")] == [str(step) for step in range(2, 25, 2)]
    np.testing.assert_array_equal(losses(killed), losses(whole))


def test_several_devices_without_torchrun_are_refused_with_the_command_that_works(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="torchrun --nproc-per-node 2"):
        train(learner(), source, replace(CONFIG, devices=2), tmp_path)
