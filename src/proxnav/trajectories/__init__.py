"""Who is where, when: trajectories from generators and from files."""

from proxnav.trajectories.assemble import PointingConfig, assemble
from proxnav.trajectories.generators import (
    ApproachConfig,
    FlightConfig,
    HoldConfig,
    ShellConfig,
    hold,
    random_shell,
    straight_approach,
)
from proxnav.trajectories.orbit import OrbitConfig
from proxnav.trajectories.read import read_trajectory
from proxnav.trajectories.readers.config import ReaderConfig
from proxnav.trajectories.safety_ellipse import (
    OBSERVATION_10_100,
    OBSERVATION_10_100_STRICT,
    SROC_200_350,
    SafetyEllipseConfig,
    walking_safety_ellipse,
)
from proxnav.trajectories.selection import clip_range, select, spread

__all__ = [
    "OBSERVATION_10_100",
    "OBSERVATION_10_100_STRICT",
    "SROC_200_350",
    "ApproachConfig",
    "FlightConfig",
    "HoldConfig",
    "OrbitConfig",
    "PointingConfig",
    "ReaderConfig",
    "SafetyEllipseConfig",
    "ShellConfig",
    "assemble",
    "clip_range",
    "hold",
    "random_shell",
    "read_trajectory",
    "select",
    "spread",
    "straight_approach",
    "walking_safety_ellipse",
]
