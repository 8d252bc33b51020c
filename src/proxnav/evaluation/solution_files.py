"""The navigation solution as a table: states, deviations, covariance, status, and errors where truth is known."""

from collections.abc import Sequence

import numpy as np

from proxnav.evaluation.navigation_errors import NavErrors
from proxnav.geometry import quaternion
from proxnav.records import NavState

_XYZ = ("x", "y", "z")


def _vector(stem: str, unit: str) -> list[str]:
    return [f"{stem}_{axis}_{unit}" for axis in _XYZ]


_ERRORS = [*_vector("r_ric", "m"), *_vector("v_ric", "mps"), *_vector("theta", "rad"), *_vector("rate", "rad_s")]
_UPPER = [(i, j) for i in range(12) for j in range(i, 12)]

STATE_COLUMNS = [
    "t_s", *_vector("r_ric", "m"), *_vector("v_ric", "mps"), *[f"q_cam_target_{c}" for c in "wxyz"],
    *_vector("t_cam_target", "m"), *_vector("rate_target", "rad_s"), *_vector("gyro_bias", "rad_s"),
    *_vector("gnss_bias", "m"),
]  # fmt: skip
SIGMA_COLUMNS = [f"sigma_{name}" for name in _ERRORS]
COVARIANCE_COLUMNS = [f"cov_{i}_{j}" for i, j in _UPPER]
ERROR_COLUMNS = [f"error_{name}" for name in _ERRORS] + ["nees", "inside_3_sigma"]


def solution_columns(states: Sequence[NavState | None], errors: NavErrors | None = None) -> dict[str, list]:
    """Columns by name; instants before the first pose are left out."""
    known = [i for i, state in enumerate(states) if state is not None]
    rows = np.array([_row(state) for state in states if state is not None]).reshape(len(known), -1)
    names = [*STATE_COLUMNS, *SIGMA_COLUMNS, *COVARIANCE_COLUMNS]
    table: dict[str, list] = {"status": [state.status for state in states if state is not None]}
    table |= {name: column.tolist() for name, column in zip(names, rows.T, strict=True)} if len(known) else {}
    if errors is not None:
        extra = np.c_[errors.errors, errors.nees, errors.inside_3_sigma][known]
        table |= {name: column.tolist() for name, column in zip(ERROR_COLUMNS, extra.T, strict=True)}
    return table


def csv_text(table: dict[str, list]) -> str:
    """With a header; numbers so that they read back the same."""
    lines = [",".join(table)]
    for row in zip(*table.values(), strict=True):
        lines.append(",".join(cell if isinstance(cell, str) else repr(cell) for cell in row))
    return "\n".join(lines) + "\n"


def _row(state: NavState) -> np.ndarray:
    P = state.covariance
    return np.concatenate(
        [[state.t], state.r_ric_m, state.v_ric_mps, quaternion.canonical(state.q_cam_target), state.t_cam_target_m,
         state.rate_target, state.gyro_bias, state.gnss_bias_m, np.sqrt(np.diagonal(P)), [P[i, j] for i, j in _UPPER]]
    )  # fmt: skip
