"""The navigation solution as a table: states, deviations, covariance, status, and errors where truth is known."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from proxnav.evaluation.navigation_errors import NavErrors
from proxnav.geometry import quaternion
from proxnav.records import NavState
from proxnav.storage.tables import quaternion_columns, read_table, vector_columns

NAME = "solution.csv"

_POSITION, _ATTITUDE = vector_columns("r_ric", "m"), vector_columns("theta", "rad")
_ERRORS = [*_POSITION, *vector_columns("v_ric", "mps"), *_ATTITUDE, *vector_columns("rate", "rad_s")]
_UPPER = np.triu_indices(12)

STATE_COLUMNS = [
    "t_s", *_POSITION, *vector_columns("v_ric", "mps"), *quaternion_columns("q_cam_target"),
    *vector_columns("t_cam_target", "m"), *vector_columns("rate_target", "rad_s"),
    *vector_columns("gyro_bias", "rad_s"), *vector_columns("gnss_bias", "m"),
]  # fmt: skip
SIGMA_COLUMNS = [f"sigma_{name}" for name in _ERRORS]
COVARIANCE_COLUMNS = [f"cov_{i}_{j}" for i, j in zip(*_UPPER, strict=True)]
ERROR_COLUMNS = [f"error_{name}" for name in _ERRORS] + ["nees", "inside_3_sigma"]


def solution_columns(states: Sequence[NavState | None], errors: NavErrors | None = None) -> dict[str, list]:
    """Columns by name; instants before the first pose are left out, and a filter that never started leaves no row."""
    known = np.array([i for i, state in enumerate(states) if state is not None], dtype=np.int64)
    names = [*STATE_COLUMNS, *SIGMA_COLUMNS, *COVARIANCE_COLUMNS]
    rows = np.array([_row(state) for state in states if state is not None]).reshape(len(known), len(names))
    table: dict[str, list] = {"status": [state.status for state in states if state is not None]}
    table |= {name: column.tolist() for name, column in zip(names, rows.T, strict=True)}
    if errors is not None:
        extra = np.c_[errors.errors, errors.nees, errors.inside_3_sigma][known]
        table |= {name: column.tolist() for name, column in zip(ERROR_COLUMNS, extra.T, strict=True)}
    return table | {"cause": [state.cause for state in states if state is not None]}


def _row(state: NavState) -> Float[np.ndarray, "n_columns"]:
    P = state.covariance
    return np.concatenate(
        [[state.t], state.r_ric_m, state.v_ric_mps, quaternion.canonical(state.q_cam_target), state.t_cam_target_m,
         state.rate_target, state.gyro_bias, state.gnss_bias_m, np.sqrt(np.diagonal(P)), P[_UPPER]]
    )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """What a report or a replay shows of a navigation solution at n instants; errors are true less estimated."""

    t: Float[np.ndarray, "n"]
    status: tuple[str, ...]
    r_ric_m: Float[np.ndarray, "n 3"]
    """Position of the camera in the target's RIC frame."""
    q_cam_target: Float[np.ndarray, "n wxyz=4"]
    sigma: Float[np.ndarray, "n 6"]
    """Standard deviations of RIC position [m] and of attitude [rad], target axes."""
    covariance_m2: Float[np.ndarray, "n 3 3"]
    """Covariance of RIC position."""
    errors: Float[np.ndarray, "n 6"]
    """Errors of RIC position [m] and attitude [rad], target axes; NaN where no truth is known."""
    nees: Float[np.ndarray, "n"]
    """Squared normalised error of the twelve states; NaN where no truth is known."""

    @property
    def has_truth(self) -> bool:
        """Whether errors are known."""
        return bool(np.isfinite(self.errors).any())


def read_solution(folder: Path) -> Solution:
    """The solution in a folder of `proxnav navigate`; InputError names what is missing."""
    table = read_table(folder / NAME)
    shown, missing = [*_POSITION, *_ATTITUDE], np.full(len(table.status), np.nan)
    covariance = [[table.column(f"cov_{min(i, j)}_{max(i, j)}") for j in range(3)] for i in range(3)]
    return Solution(
        t=table.column("t_s"),
        status=table.status,
        r_ric_m=table.block(*_POSITION),
        q_cam_target=table.block(*quaternion_columns("q_cam_target")),
        sigma=table.block(*(f"sigma_{name}" for name in shown)),
        covariance_m2=np.moveaxis(np.array(covariance), -1, 0),
        errors=np.stack([table.columns.get(f"error_{name}", missing) for name in shown], axis=1),
        nees=table.columns.get("nees", missing),
    )
