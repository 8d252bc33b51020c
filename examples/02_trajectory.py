"""Who is where, when: a passively safe spiral past the target, its lit part, and a picture of it."""

from pathlib import Path

import numpy as np

from proxnav.trajectories import SafetyEllipseConfig, select, spread, walking_safety_ellipse
from proxnav.viewing.plots import trajectory_ric


def main(out: Path = Path("out/examples"), orbits: float = 4.0) -> Path:
    """Flies the spiral, says what the camera will meet, and draws it in the target's RIC frame."""
    flight = walking_safety_ellipse(SafetyEllipseConfig(orbits=orbits, step_s=20.0))
    lit = flight.sun_visible > 0.5
    print(f"{len(flight)} instants from {flight.epoch_utc}, range {flight.range_m.min():.1f} to", end=" ")
    print(f"{flight.range_m.max():.1f} m, {100 * np.mean(lit):.0f} % in sunlight")

    for k, T in enumerate(map(spread(select(flight, lit), 3).T_cam_target, range(3))):
        print(f"view {k}: target at {T.t_m.round(2) + 0.0} m in camera axes (x right, y down, z forward)")

    out.mkdir(parents=True, exist_ok=True)
    picture = out / "02_trajectory.png"
    trajectory_ric(flight).savefig(picture, dpi=100)
    print(f"the flight in {picture}")
    return picture


if __name__ == "__main__":
    main()
