"""Short simulated flights that several tests use."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from proxnav.evaluation.navigation_errors import NavErrors, nav_errors
from proxnav.flight.simulate import SensingConfig, SimulationConfig, simulate
from proxnav.flight.truth import Truth, TruthConfig
from proxnav.flight.truth_files import true_states
from proxnav.geometry import Camera
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.navigator import Judged, run_filter
from proxnav.records import SensorRecords, Trajectory
from proxnav.targets.loading import load_target
from proxnav.trajectories import HoldConfig, hold

CAMERA = Camera(width=1024, height=1024, fx=1407.0, fy=1407.0, cx=512.0, cy=512.0)
SENSING = SensingConfig()
TIGHT = NavigationConfig(coupling="tight")


def points() -> np.ndarray:
    """Keypoints of the target [m]."""
    return load_target("space-rider").keypoints_m


def reference(seconds: float) -> Trajectory:
    """A hold 30 m behind the target."""
    return hold(HoldConfig(duration_s=seconds, step_s=10.0))


@lru_cache(maxsize=16)
def fly(seconds: float = 120.0, seed: int = 0, sensing: SensingConfig = SENSING) -> tuple[Truth, SensorRecords]:
    """Truth and records of a hold, half a second a step."""
    config = SimulationConfig(TruthConfig(step_s=0.5), sensing)
    return simulate(reference(seconds), load_target("space-rider"), CAMERA, config, np.random.default_rng(seed))


def filtered(
    truth: Truth, records: SensorRecords, config: NavigationConfig | None = None
) -> tuple[NavErrors, list[Judged], int]:
    """Errors every five seconds, verdicts, and how often the filter started."""
    setup = setup_of(records, points(), CAMERA, config or TIGHT)
    t = np.arange(truth.t[0] + 5.0, truth.t[-1], 5.0)
    states, judged, last = run_filter(records, setup, t)
    return nav_errors(states, true_states(truth).at(t)), judged, last.memory.starts


def without(records: SensorRecords, *names: str) -> SensorRecords:
    """The records of a craft that lacks some sensors."""
    return replace(records, **dict.fromkeys(names))
