"""`proxnav evaluate`: poses against truth."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class EvaluateConfig:
    """Compares poses with the truth and prints the study's Table 1 beside these, errors by range, and other scores.

    Two Pose Bowl tables get that challenge's score; trajectories (TUM, solution.csv) are compared at equal times.
    """

    estimates: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="ESTIMATES")]
    """poses.json of `proxnav estimate` or `proxnav solve`, or any other format that `proxnav convert` reads."""
    truth: Annotated[Path, tyro.conf.Positional, tyro.conf.arg(metavar="TRUTH")]
    """A data set folder, or labels in any such form; images without an estimate count as frames without a pose."""
    target: str | None = None
    """Name or file of the target whose surface ADD, ADD-S, MSSD and MSPD take; a BOP set brings its own."""
    camera: Path | None = None
    """Calibration file for MSPD; the truth's own when not given."""
    object_id: int | None = None
    """Which object, where a BOP set shows several."""
    within: tuple[str, ...] = ()
    """Further limits for the recall, such as 0.2m,3deg."""
    json: bool = False
    """Print one JSON object instead of the tables."""


def run(config: EvaluateConfig) -> None:
    """Reads, compares, prints."""
    from proxnav.evaluation.comparison import compare, pose_bowl_files
    from proxnav.evaluation.object_model import ObjectModel
    from proxnav.geometry import Camera
    from proxnav.targets.loading import load_target

    chains = pose_bowl_files(config.estimates, config.truth)
    if chains is not None:
        lines = [f"{name.replace('_', ' ')}: {value:.6g}" for name, value in asdict(chains).items()]
        print(json.dumps(asdict(chains), indent=1) if config.json else "\n".join(lines))
        return
    model = None if config.target is None else ObjectModel.of_points(load_target(config.target).vertices_m)
    camera = None if config.camera is None else Camera.read(config.camera)
    found = compare(config.estimates, config.truth, model, camera, config.object_id, config.within)
    print(json.dumps(found.metrics(), indent=1) if config.json else found.text())
