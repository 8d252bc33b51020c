"""`proxnav target show`: what a target is, and how well its keypoints can be solved."""

from dataclasses import dataclass
from pathlib import Path

import tyro


@dataclass(frozen=True)
class TargetShowConfig:
    """Draws a target from eight sides with its keypoints, and prints its size, parts and keypoints."""

    target: tyro.conf.Positional[str]
    """space-rider, tango, a target.json or its folder, or a mesh file in metres."""
    out: Path | None = None
    """Picture to write, PNG; none when not given."""
    size: int = 480
    """Side of each view [px]."""


def run(config: TargetShowConfig) -> None:
    """Prints and draws the target."""
    from proxnav.missions import load_mission
    from proxnav.pose.solve.best_accuracy import accuracy_table
    from proxnav.targets.description import description
    from proxnav.targets.loading import load_target
    from proxnav.targets.preview import write_contact_sheet

    target = load_target(config.target)
    print(description(target))
    print(accuracy_table(target, load_mission("observation-10-100m").camera))
    if config.out is not None:
        write_contact_sheet(target, config.out, config.size)
        print(f"preview in {config.out}")
