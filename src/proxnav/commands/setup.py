"""`proxnav setup blender`: installs Blender's Python module in an environment of its own."""

import sys
from dataclasses import dataclass
from typing import Annotated, Literal

import tyro


@dataclass(frozen=True)
class Setup:
    """Installs what pip cannot bring with proxnav itself. Running it again is harmless."""

    what: Annotated[Literal["blender"], tyro.conf.Positional]
    """blender: bpy 4.5 LTS (GPL-3) in a virtual environment in the user's data folder, or in $PROXNAV_HOME."""


def run(config: Setup) -> None:
    """Installs it."""
    from proxnav.rendering.cycles.environment import make_environment

    make_environment(lambda text: print(text, file=sys.stderr, flush=True))
