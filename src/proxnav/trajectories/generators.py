"""Trajectories from parameters: hold, straight approach, random shell; the target flies a circular orbit, LVLH-fixed.

The walking safety ellipse has a file of its own. Positions are in the target's RIC frame: x radial outward,
y in-track, z cross-track.
"""

from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from proxnav.errors import InputError
from proxnav.geometry.arrays import unit
from proxnav.geometry.relative_motion import eci_from_ric
from proxnav.geometry.types import Vector3
from proxnav.records import Trajectory
from proxnav.records.scene import Triple
from proxnav.trajectories.assemble import PointingConfig, assemble
from proxnav.trajectories.orbit import OrbitConfig, fly_orbit

DEFAULT_EPOCH = "2024-11-01T00:00:00Z"


@dataclass(frozen=True)
class FlightConfig:
    """What all generators share."""

    epoch_utc: str = DEFAULT_EPOCH
    orbit: OrbitConfig = field(default_factory=OrbitConfig)
    """Orbit of the target."""
    pointing: PointingConfig = field(default_factory=PointingConfig)


@dataclass(frozen=True)
class HoldConfig:
    """The chaser stays at one place in RIC, by control."""

    position_m: Triple = (0.0, -30.0, 0.0)
    duration_s: float = 600.0
    step_s: float = 1.0


@dataclass(frozen=True)
class ApproachConfig:
    """The chaser moves on a straight line in RIC at constant speed, by control."""

    start_m: Triple = (0.0, -100.0, 0.0)
    end_m: Triple = (0.0, -10.0, 0.0)
    duration_s: float = 600.0
    step_s: float = 1.0


@dataclass(frozen=True)
class ShellConfig:
    """Independent viewpoints around the target: a data set, not a flight."""

    count: int = 100
    range_m: tuple[float, float] = (10.0, 100.0)
    """Least and most, uniform in between; directions are uniform on the sphere."""
    step_s: float = 60.0
    """Time between viewpoints, which moves Sun and Earth."""
    seed: int = 0


def hold(config: HoldConfig | None = None, flight: FlightConfig | None = None) -> Trajectory:
    """The chaser at rest in the target's RIC frame."""
    config = config or HoldConfig()
    t = time_grid(config.duration_s, config.step_s)
    rho = np.tile(np.array(config.position_m), (len(t), 1))
    return fly_relative(t, rho, np.zeros_like(rho), flight or FlightConfig(), "hold")


def straight_approach(config: ApproachConfig | None = None, flight: FlightConfig | None = None) -> Trajectory:
    """The chaser on a straight line from start to end."""
    config = config or ApproachConfig()
    t = time_grid(config.duration_s, config.step_s)
    start, end = np.array(config.start_m), np.array(config.end_m)
    rho_dot = np.tile((end - start) / config.duration_s, (len(t), 1))
    return fly_relative(t, start + t[:, None] * rho_dot, rho_dot, flight or FlightConfig(), "straight approach")


def random_shell(config: ShellConfig | None = None, flight: FlightConfig | None = None) -> Trajectory:
    """One random viewpoint at every instant."""
    config = config or ShellConfig()
    low, high = config.range_m
    if config.count < 1 or not 0.0 < low <= high:
        raise InputError(f"a shell needs count >= 1 and 0 < least <= most, found {config.count}, {config.range_m}")
    rng = np.random.default_rng(config.seed)
    rho = rng.uniform(low, high, size=(config.count, 1)) * unit(rng.normal(size=(config.count, 3)))
    t = config.step_s * np.arange(config.count)
    return fly_relative(t, rho, np.zeros_like(rho), flight or FlightConfig(), "random shell")


def fly_relative(
    t: Float[np.ndarray, "n"], rho_ric: Vector3, rho_dot_ric: Vector3, flight: FlightConfig, source: str
) -> Trajectory:
    """A relative path in RIC [m, m/s] as a full trajectory about the target's circular orbit."""
    target = fly_orbit(flight.orbit, t)
    chaser = eci_from_ric(*target, rho_ric, rho_dot_ric)
    return assemble(flight.epoch_utc, t, target, chaser, pointing=flight.pointing, source=source)


def time_grid(duration_s: float, step_s: float) -> Float[np.ndarray, "n"]:
    """Instants 0, step, ... up to the duration, end included where it is a whole number of steps."""
    if not (step_s > 0.0 and np.isfinite(duration_s) and duration_s >= 0.0):
        raise InputError(f"a trajectory needs step_s > 0 and duration_s >= 0, found {step_s} and {duration_s}")
    return step_s * np.arange(int(np.floor(duration_s / step_s + 1e-9)) + 1)
