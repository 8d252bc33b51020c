"""Parts of a trajectory."""

from dataclasses import fields, replace

import numpy as np
from jaxtyping import Bool, Int

from proxnav.errors import InputError
from proxnav.records import Trajectory


def select(trajectory: Trajectory, index: Int[np.ndarray, "m"] | Bool[np.ndarray, "n"]) -> Trajectory:
    """The instants that an index array or a mask picks, in order of time."""
    series = [f.name for f in fields(trajectory) if f.name not in ("epoch_utc", "source")]
    return replace(trajectory, **{name: getattr(trajectory, name)[index] for name in series})


def clip_range(trajectory: Trajectory, least_m: float, most_m: float) -> Trajectory:
    """The instants at which the camera is between `least_m` and `most_m` from the target's origin."""
    inside = (trajectory.range_m >= least_m) & (trajectory.range_m <= most_m)
    if not inside.any():
        low, high = trajectory.range_m.min(), trajectory.range_m.max()
        raise InputError(
            f"{trajectory.source} runs from {low:.1f} m to {high:.1f} m and never between {least_m} m and {most_m} m: "
            "widen the range"
        )
    return select(trajectory, inside)


def clip_time(trajectory: Trajectory, start_s: float, duration_s: float | None) -> Trajectory:
    """The instants from `start_s` for `duration_s`, to the end for None."""
    end = np.inf if duration_s is None else start_s + duration_s
    keep = (trajectory.t >= start_s - 1e-9) & (trajectory.t <= end + 1e-9)
    if keep.sum() < 2:
        raise InputError(
            f"--start-s {start_s:g} and --duration-s leave {keep.sum()} instants of a trajectory from "
            f"{trajectory.t[0]:g} to {trajectory.t[-1]:g} s; at least 2 are needed"
        )
    return select(trajectory, np.flatnonzero(keep))


def observable(trajectory: Trajectory, max_phase_rad: float) -> Bool[np.ndarray, "n"]:
    """Instants at which the target is sunlit and the angle Sun-target-camera is at most `max_phase_rad`."""
    return (trajectory.sun_visible > 0.5) & (trajectory.phase_rad < max_phase_rad)


def spread(trajectory: Trajectory, count: int) -> Trajectory:
    """`count` instants spread evenly over the trajectory, first and last included; all of them if there are fewer."""
    if count < 1:
        raise InputError(f"a trajectory needs at least one instant, asked for {count}")
    n = len(trajectory)
    return trajectory if count >= n else select(trajectory, np.linspace(0, n - 1, count).round().astype(int))
