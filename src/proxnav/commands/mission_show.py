"""`proxnav mission show`: a contact sheet of a mission, and what is physically possible in it."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro


@dataclass(frozen=True)
class MissionShowConfig:
    """Draws some frames of a mission and prints the accuracy, the light and the motion that it allows."""

    mission: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="MISSION")]
    """Name of a shipped mission, or a TOML file: docs/missions.md"""
    out: Path | None = None
    """Picture to write; MISSION.png in the working folder when not given."""
    frames: int = 12
    """Frames in the picture."""
    drawn: int = 200
    """Frames that the shares of light are counted on."""
    seed: int = 0
    """Same seed, same frames."""


def run(config: MissionShowConfig) -> None:
    """Prints the tables, then draws."""
    from proxnav.cli.progress import progress, say_when_compiling
    from proxnav.errors import InputError
    from proxnav.mission_preview import write_sheet
    from proxnav.missions import load_mission
    from proxnav.missions.feasibility import feasibility
    from proxnav.missions.scenes import mission_scenes
    from proxnav.targets.loading import load_target

    if not 1 <= config.frames <= config.drawn:
        raise InputError(f"--frames {config.frames}: give at least 1 and at most the {config.drawn} of --drawn")
    mission = load_mission(config.mission)
    target = load_target(mission.target)
    scenes = mission_scenes(mission, config.drawn, config.seed)
    print(f"{mission.describe()}\n\n{feasibility(mission, target, scenes).text()}")
    say_when_compiling("rendering")
    out = config.out or Path(f"{mission.name}.png")
    shown = scenes[:: max(1, len(scenes) // config.frames)][: config.frames]
    with progress("draw", len(shown)) as done:
        write_sheet(out, shown, target, done)
    print(f"\n{out}")
