"""Where is it, all the time? Camera, gyro, star tracker and GNSS through the filter, compared with the truth."""

from pathlib import Path

import numpy as np

from proxnav.evaluation.navigation_errors import nav_errors
from proxnav.evaluation.solution_files import read_solution, solution_columns
from proxnav.flight.simulate import SimulationConfig, simulate
from proxnav.flight.truth_files import true_states
from proxnav.missions import fly, load_mission
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.navigator import run_filter
from proxnav.storage.tables import write_columns
from proxnav.targets.loading import load_target
from proxnav.trajectories import select
from proxnav.viewing.report_filter import filter_section


def main(out: Path = Path("out/examples"), seconds: float = 120.0) -> np.ndarray:
    """Flies the first part of the approach, filters what the sensors say, and prints how honest the filter is."""
    flight = fly("approach-100-10m")
    flight = select(flight, np.flatnonzero(flight.t <= flight.t[0] + seconds))
    target, camera, config = load_target("space-rider"), load_mission("observation-10-100m").camera, NavigationConfig()

    truth, records = simulate(flight, target, camera, SimulationConfig(), np.random.default_rng(0))
    t = np.arange(truth.t[0] + 1.0, truth.t[-1], 1.0)
    states, _, _ = run_filter(records, setup_of(records, target.keypoints_m, camera, config), t)
    errors = nav_errors(states, true_states(truth).at(t))

    solution = out / "08_navigation" / "solution.csv"
    write_columns(solution, solution_columns(states, errors))
    section = filter_section(read_solution(solution.parent))
    assert section is not None
    for row in section["rows"]:
        print(f"{row['name']:22} RMS {row['rms']:>8}   inside 3 sigma {row['inside']:>7} (honest {section['honest']})")
    last = errors.errors[-1, :3]
    off, range_m = np.linalg.norm(last), flight.range_m[-1]
    print(f"position error after {seconds:.0f} s: {off:.2f} m at {range_m:.0f} m; {solution}")
    return last


if __name__ == "__main__":
    main()
