"""Named scenarios as Python objects; a command takes one by name and overrides single fields."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from proxnav.errors import InputError
from proxnav.geometry import Camera
from proxnav.records import Trajectory
from proxnav.scenes.random_scene import RandomSceneConfig
from proxnav.scenes.random_sun import SunConfig
from proxnav.scenes.random_view import ViewConfig
from proxnav.sensor.presets import SPEED_CLASS
from proxnav.trajectories import (
    OBSERVATION_10_100_STRICT,
    SROC_200_350,
    ApproachConfig,
    FlightConfig,
    HoldConfig,
    hold,
    straight_approach,
    walking_safety_ellipse,
)

NAVIGATION_CAMERA = Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
"""40 deg on 1024 px."""
PAYLOAD_CAMERA = Camera(width=2048, height=2048, fx=20_000.0, fy=20_000.0, cx=1024.0, cy=1024.0)
"""5.9 deg on 2048 px: 1 cm per pixel at 200 m."""


@dataclass(frozen=True)
class Preset:
    """A target, a camera and the scenes that it sees."""

    name: str
    target: str = "space-rider"
    camera: Camera = NAVIGATION_CAMERA
    scenes: RandomSceneConfig = field(default_factory=lambda: OBSERVATION)
    """Frames drawn one by one; of a trajectory only what it leaves open (the sensor) is taken from here."""
    frames: int = 100
    trajectory: str = ""
    """Name of one of `FLIGHTS`; empty for random scenes."""


DAYLIGHT = FlightConfig(epoch_utc="2024-11-01T00:30:00Z")
"""The target comes out of Earth's shadow as the flight begins."""

OBSERVATION = RandomSceneConfig(
    view=ViewConfig(range_m=(10.0, 100.0), roll_limit_rad=math.radians(30.0), partial_share=0.05),
    sun=SunConfig(max_phase_rad=math.radians(90.0)),
    earth_share=0.5,
    texture_strength=(0.0, 0.3),
    sensor=SPEED_CLASS,
)
"""Lit target, camera up within 30 deg of the local vertical, Earth in half of the frames, full sensor noise."""

STUDY = RandomSceneConfig(
    view=ViewConfig(range_m=(10.0, 100.0), roll_limit_rad=math.radians(30.0)),
    sun=SunConfig(max_phase_rad=math.radians(90.0)),
    earth_share=0.5,
    texture_strength=(0.0, 1.0),
    sensor=SPEED_CLASS,
)
"""The same views with the textures of the target randomised, as the seed study trained."""

TRAINING = replace(OBSERVATION, texture_strength=(0.0, 1.0), sun=SunConfig(max_phase_rad=math.radians(110.0)))
"""Wider than what is tested: textures fully randomised, more oblique light."""

PRESETS = {
    preset.name: preset
    for preset in (
        Preset("observation-10-100m", scenes=OBSERVATION),
        Preset("study", scenes=STUDY, frames=5000),
        Preset("spiral-10-100m", trajectory="spiral-10-100m", frames=200),
        Preset("approach-100-10m", trajectory="approach-100-10m", frames=200),
        Preset("sroc-200-350m", camera=PAYLOAD_CAMERA, trajectory="spiral-200-350m", frames=200),
    )
}


FLIGHTS: dict[str, Callable[[], Trajectory]] = {
    "spiral-10-100m": lambda: walking_safety_ellipse(OBSERVATION_10_100_STRICT, DAYLIGHT),
    "spiral-200-350m": lambda: walking_safety_ellipse(SROC_200_350, DAYLIGHT),
    "approach-100-10m": lambda: straight_approach(ApproachConfig(), DAYLIGHT),
    "hold-30m": lambda: hold(HoldConfig(), DAYLIGHT),
}
"""Trajectories by name."""


def preset(name: str) -> Preset:
    """The preset of that name; InputError lists the others."""
    if name not in PRESETS:
        raise InputError(f"no preset '{name}'; one of {', '.join(PRESETS)}")
    return PRESETS[name]


def flight(name: str) -> Trajectory:
    """The trajectory of that name; InputError lists the others."""
    if name not in FLIGHTS:
        raise InputError(f"no trajectory '{name}'; one of {', '.join(FLIGHTS)}, or give a file")
    return FLIGHTS[name]()
