"""Trajectories of missions: generated ones by name, or from files."""

from collections.abc import Callable
from dataclasses import replace

from proxnav.errors import InputError, did_you_mean
from proxnav.missions.mission import Mission
from proxnav.records import Trajectory
from proxnav.trajectories import (
    OBSERVATION_10_100_STRICT,
    SROC_200_350,
    ApproachConfig,
    FlightConfig,
    HoldConfig,
    OrbitConfig,
    hold,
    read_trajectory,
    straight_approach,
    walking_safety_ellipse,
)

DAYLIGHT = FlightConfig(epoch_utc="2024-11-01T00:30:00Z")
"""Epoch of whole orbits: the target comes out of Earth's shadow a seventh of an orbit after the flight begins."""

AFTERNOON = replace(DAYLIGHT, orbit=OrbitConfig(argument_of_latitude_deg=250.0))
"""Ten minutes from behind: lit throughout, the Sun 58 deg from behind the camera at first, 21 deg at last."""

SUMMER = replace(DAYLIGHT, epoch_utc="2024-06-01T00:30:00Z")
"""Epoch of the far ellipse: seen from its side of the orbit the Sun stays within 63 deg from behind the camera."""

FLIGHTS: dict[str, Callable[[], Trajectory]] = {
    "spiral-10-100m": lambda: walking_safety_ellipse(OBSERVATION_10_100_STRICT, DAYLIGHT),
    "spiral-200-350m": lambda: walking_safety_ellipse(SROC_200_350, SUMMER),
    "approach-100-10m": lambda: straight_approach(ApproachConfig(), AFTERNOON),
    "hold-30m": lambda: hold(HoldConfig(), AFTERNOON),
}


def fly(name: str) -> Trajectory:
    """The trajectory of that name; InputError lists the others."""
    if name not in FLIGHTS:
        raise InputError(
            f"no trajectory '{name}'; one of {', '.join(FLIGHTS)}, or give a file{did_you_mean(name, FLIGHTS)}"
        )
    return FLIGHTS[name]()


def fly_mission(mission: Mission) -> Trajectory:
    """The trajectory of a mission; InputError where it has none, but independent frames."""
    if mission.flight.files:
        return read_trajectory(mission.flight.files, mission.flight.reader)
    if not mission.flight.trajectory:
        raise InputError(f"mission '{mission.name}' has no trajectory to fly; spiral-10-100m, for one, has")
    return fly(mission.flight.trajectory)
