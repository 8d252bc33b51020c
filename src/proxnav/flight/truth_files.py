"""The true relative state as csv, beside the records, for whoever wants to know the filter's error."""

from dataclasses import dataclass, fields
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.datasets.sensor_records.record_files import read_columns
from proxnav.errors import InputError
from proxnav.flight.truth import Truth
from proxnav.geometry import quaternion
from proxnav.geometry.arrays import frozen
from proxnav.storage.tables import quaternion_columns, vector_columns, write_rows

COLUMNS = (
    "t_s", *vector_columns("r_ric", "m"), *vector_columns("v_ric", "mps"), *quaternion_columns("q_cam_target"),
    *vector_columns("rate_target", "rad_s"),
)  # fmt: skip

_BLOCKS = (1, 4, 7, 11)
"""Where position, velocity, attitude and rate begin among them."""


@dataclass(frozen=True, slots=True, eq=False)
class TrueStates:
    """What the filter estimates, as it is, at n increasing instants."""

    t: Float[np.ndarray, "n"]
    """Seconds since the epoch."""
    r_ric_m: Float[np.ndarray, "n 3"]
    """Chaser relative to the target, RIC axes."""
    v_ric_mps: Float[np.ndarray, "n 3"]
    """Rate of that position in the rotating RIC frame."""
    q_cam_target: Float[np.ndarray, "n wxyz=4"]
    rate_target: Float[np.ndarray, "n 3"]
    """Inertial rate of the target, target axes [rad/s]."""

    def __post_init__(self) -> None:
        n = len(self.t)
        for f in fields(self):
            shape = {"t": (n,), "q_cam_target": (n, 4)}.get(f.name, (n, 3))
            object.__setattr__(self, f.name, frozen(getattr(self, f.name), shape, f.name))

    def at(self, t: Float[np.ndarray, "m"]) -> "TrueStates":
        """Interpolated at `t`: linear, and along the great arc for the attitude. InputError outside the span."""
        t = np.asarray(t, dtype=np.float64)
        if len(t) and (t.min() < self.t[0] - 1e-6 or t.max() > self.t[-1] + 1e-6):
            raise InputError(
                f"the truth covers t = {self.t[0]:g} to {self.t[-1]:g} s, the solution {t.min():g} to {t.max():g} s"
            )
        k = np.clip(np.searchsorted(self.t, t, side="right") - 1, 0, len(self.t) - 2)
        f = np.clip((t - self.t[k]) / (self.t[k + 1] - self.t[k]), 0.0, 1.0)
        q = quaternion.slerp(self.q_cam_target[k], self.q_cam_target[k + 1], f)

        def mixed(x: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "m 3"]:
            return x[k] + f[:, None] * (x[k + 1] - x[k])

        return TrueStates(t, mixed(self.r_ric_m), mixed(self.v_ric_mps), q, mixed(self.rate_target))


def true_states(truth: Truth, every: int = 1) -> TrueStates:
    """True states at every so many-th sample."""
    rho, rho_dot = truth.relative
    k = slice(None, None, every)
    return TrueStates(truth.t[k], rho[k], rho_dot[k], truth.q_cam_target[k], truth.rate_target[k])


def write_truth(path: Path, states: TrueStates) -> None:
    """Csv with `COLUMNS`."""
    rows = np.c_[states.t, states.r_ric_m, states.v_ric_mps, states.q_cam_target, states.rate_target]
    write_rows(path, [COLUMNS, *rows.tolist()])


def read_truth(path: Path) -> TrueStates:
    """Inverse of `write_truth`."""
    rows = read_columns(path, COLUMNS)
    if len(rows) < 2 or not np.isfinite(rows).all() or (np.diff(rows[:, 0]) <= 0).any():
        raise InputError(f"{path}: the truth needs two rows or more of finite numbers at increasing times")
    t, r, v, q, rate = np.split(rows, _BLOCKS, axis=1)
    return TrueStates(t[:, 0], r, v, q, rate)
