"""A trajectory as csv: one row an instant, headers that say object, frame (ECI: J2000 axes) and unit."""

from collections.abc import Sequence
from typing import Literal

import numpy as np

from proxnav.geometry import quaternion
from proxnav.geometry.epochs import parse_iso
from proxnav.records import Trajectory

Craft = Literal["target", "chaser"]


def flight_csv(flight: Trajectory, orbits: Sequence[Craft], attitudes: Sequence[Craft]) -> str:
    """Content of the file: UTC, then position [m] and velocity [m/s] of each orbit, then quaternions (body to ECI)."""
    epoch = parse_iso(flight.epoch_utc)
    header, blocks = ["Time (UTC)"], [np.empty((len(flight), 0))]
    for craft in orbits:
        header += [f"ECI {axis}_{craft} (m)" for axis in "XYZ"] + [f"ECI V{axis}_{craft} (m/s)" for axis in "xyz"]
        own = craft == "target"
        blocks.append(flight.r_eci_target_m if own else flight.r_eci_chaser_m)
        blocks.append(flight.v_eci_target_mps if own else flight.v_eci_chaser_mps)
    for craft in attitudes:
        header += [f"q{axis}_{craft}" for axis in "wxyz"]
        blocks.append(quaternion.normalize(flight.q_eci_target if craft == "target" else flight.q_eci_cam))
    numbers = np.concatenate(blocks, axis=1)
    stamps = [epoch.plus(float(t)).iso(9) for t in flight.t]
    rows = [",".join([stamp, *map(repr, row)]) for stamp, row in zip(stamps, numbers.tolist(), strict=True)]
    return "\n".join([",".join(header), *rows, ""])
