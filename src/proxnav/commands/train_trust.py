"""`proxnav train trust`: the trust of a model folder, calibrated on fresh frames."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import WorkerOptions


@dataclass(frozen=True)
class TrainTrustConfig(WorkerOptions):
    """Draws frames of the model's mission and of harder conditions, and writes what they teach into model.json."""

    model: Annotated[Path, tyro.conf.Positional]
    """Model folder."""
    mission: str = ""
    """Name or file of a mission; the model's own when empty."""
    frames: int = 60
    """Frames under each condition; 1000 and more carry a risk of 1e-3 by themselves, fewer by their tail."""
    out: Path = Path("out/trust-calibration")
    """Folder of the answers, where an interrupted run goes on."""


def run(config: TrainTrustConfig) -> None:
    """Draws, fits, writes."""
    from proxnav.cli.progress import progress
    from proxnav.errors import InputError
    from proxnav.learning.trust_calibration import calibrate_trust
    from proxnav.missions import load_mission, mission_in

    mission = mission_in(config.model) if not config.mission else load_mission(config.mission)
    if mission is None:
        raise InputError(f"{config.model}: does not say its mission; name one with --mission")
    card = calibrate_trust(config.model, mission, config.frames, config.workers, config.on, config.out, progress)
    if card.trust is None:
        raise InputError(f"{config.frames} frames a condition gave too few good or hazardous poses: draw more --frames")
    told, untold = card.trust.told.hazard.limit, card.trust.untold.hazard.limit
    print(f"{config.model}: trust calibrated on {card.trust.frames} poses; poses are refused above a probability of "
          f"{told:.4f} (Sun told) and {untold:.4f} (no Sun)")  # fmt: skip
