"""What torchrun starts in test_ranks.py: a tiny training; `dies` kills the second rank once, in step 15."""

import os
import signal
import sys
from dataclasses import replace
from itertools import count
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import numpy as np
import torch
from test_training import CONFIG, loss, source
from torch import nn

from proxnav.detection.training.learner import Learner
from proxnav.detection.training.loop import train
from proxnav.detection.training.rates import warm_up_then_cosine

STEPS = 24


def collate(samples, step, rng):
    """Without chance, so that the ranks together see what one process with twice the batch sees."""
    images = np.stack([s.image for s in samples]).astype(np.float32)[:, None] / 255.0
    points = np.stack([s.keypoints_px[0] for s in samples]).astype(np.float32)
    return {"images": torch.from_numpy(images), "points": torch.from_numpy(points)}


def main(out: Path, batch: int, kind: str, dies: bool) -> None:
    torch.manual_seed(5)
    dropout = [nn.Dropout(0.2)] if kind == "dropout" else []
    model = nn.Sequential(nn.Conv2d(1, 4, 3), nn.ReLU(), *dropout, nn.Flatten(), nn.Linear(144, 2))
    calls, mark = count(), out / "died"

    def fragile(model, batch):
        if next(calls) == 30 and dies and os.environ.get("RANK") == "1" and not mark.exists():
            mark.touch()
            os.kill(os.getpid(), signal.SIGKILL)
        return loss(model, batch)

    optimizer = torch.optim.SGD(model.parameters(), lr=0.1, momentum=0.9)
    learner = Learner(model, optimizer, warm_up_then_cosine(0.1, STEPS, 3), collate, fragile)
    config = replace(CONFIG, steps=STEPS, batch_size=batch, save_every=6, devices=int(os.environ.get("WORLD_SIZE", 1)))
    train(learner, source, config, out)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3], "dies" in sys.argv)
