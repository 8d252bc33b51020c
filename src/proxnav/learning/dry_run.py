"""`train ... --dry-run`: a few samples are drawn and learnt from in a temporary folder, timed, and scaled up."""

import os
import time
from dataclasses import replace
from itertools import cycle
from pathlib import Path
from tempfile import TemporaryDirectory

from proxnav.cluster.forecast import Forecast, folder_bytes
from proxnav.learning.training import Training

_DRAWN = 8


def training_dry_run(training: Training) -> str:
    """What training would take: eight samples are drawn, and learnt from in 2 and then 6 steps.

    Drawing and learning share the cores.
    """
    loop = training.loop
    batch = loop.batch_size * loop.accumulate
    make = training.draw()
    make(0)
    start = time.perf_counter()
    drawn = [make(index) for index in range(1, 1 + _DRAWN)]
    drawing = (time.perf_counter() - start) / len(drawn) / training.repeats
    with TemporaryDirectory() as folder:
        walls = []
        for steps in (2, 6):
            start = time.perf_counter()
            training.learn(replace(loop, steps=steps), lambda begin, stride: cycle(drawn), Path(folder), None)
            walls.append(time.perf_counter() - start)
        written = folder_bytes(Path(folder))
    learning, cores = max(walls[1] - walls[0], 0.2 * walls[1]) / (2 * batch), os.cpu_count() or 1
    if cores > training.workers:
        each = max(learning, drawing / training.workers)
    else:
        each = (learning * cores + drawing) / cores
    return Forecast(walls[0] + each * loop.steps * batch, written).text(f"{loop.steps} steps of {batch} samples")
