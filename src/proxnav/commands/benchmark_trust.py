"""`proxnav benchmark trust`: how often a model is confidently wrong, by condition, before and after the verdict."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from proxnav.cli.options import MissionOptions, ModelOptions, WorkerOptions


@dataclass(frozen=True)
class TrustBenchmarkConfig(MissionOptions, ModelOptions, WorkerOptions):
    """Draws frames under each condition, estimates with and without the Sun told; goes on where it was interrupted."""

    out: Path = Path("out/trust")
    """Folder of the answers (kept and taken over), trust.json, roc.png and the Stanford diagrams."""
    frames: int = 60
    """Frames under each condition."""
    seed: int = 80_000
    other: Annotated[tuple[str, ...], tyro.conf.arg(metavar="TARGET ...")] = ()
    """Other craft, by name or file; the shipped ones that are not the target when none is given."""
    only: str = ""
    """Only conditions whose name holds this text."""
    json: bool = False
    """Print JSON instead of a table."""


def run(config: TrustBenchmarkConfig) -> None:
    """Draws, estimates, judges, and gives the table."""
    import json

    from proxnav.benchmarks.trust import text, trust_table
    from proxnav.benchmarks.trust_figures import save_figures
    from proxnav.cli.progress import progress
    from proxnav.estimator import trust_of
    from proxnav.models.loading import load_model
    from proxnav.storage.files import write_json
    from proxnav.trials.conditions import all_conditions
    from proxnav.trials.running import TrialRun

    mission = config.read_mission()
    conditions = all_conditions(mission, config.other, config.only)
    results = TrialRun(
        mission,
        config.model,
        config.frames,
        config.seed,
        config.backend,
        config.workers,
        config.on,
        config.out,
        progress,
    ).results(conditions)
    trust = trust_of(load_model(config.model))
    found = {"model": config.model, "mission": mission.name, "seed": config.seed} | trust_table(results, trust)
    write_json(config.out / "trust.json", found, indent=1)
    save_figures(results, trust, config.out)
    print(json.dumps(found, indent=1) if config.json else text(found))
