"""The trust of a model calibrated on fresh frames of its mission and of harder conditions."""

from dataclasses import replace
from pathlib import Path

from proxnav.cluster.jobs import POOL
from proxnav.cluster.progress import Progress, silent
from proxnav.errors import InputError
from proxnav.estimator import trust_of
from proxnav.missions import Mission
from proxnav.models.card import ModelCard, write_card
from proxnav.models.loading import load_model
from proxnav.trials.calibration import calibrated_trust
from proxnav.trials.conditions import all_conditions, teaches
from proxnav.trials.running import TrialRun

_SEED = 70_000


def calibrate_trust(
    model: Path, mission: Mission, frames: int, workers: int = 1, on: str = POOL, kept: Path | None = None,
    progress: Progress = silent,
) -> ModelCard:  # fmt: skip
    """Draws `frames` frames under each condition and writes what they teach into the model's card, which is returned.

    Its `trust` is None where they are too few. The answers are kept in the folder `kept`, where an interrupted run goes
    on. InputError for models whose poses are not aligned.
    """
    loaded = load_model(str(model))
    if loaded.shape is None:
        raise InputError(f"{model}: trust is calibrated for models whose poses are aligned; this one has no alignment")
    run = TrialRun(mission, str(model), frames, _SEED, workers=workers, on=on, out=kept, progress=progress)
    results = run.results([one for one in all_conditions(mission) if teaches(one.name)])
    card = replace(loaded.card, trust=calibrated_trust(results, trust_of(loaded)))
    write_card(model, card)
    return card
