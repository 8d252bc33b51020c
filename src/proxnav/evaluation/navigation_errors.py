"""The filter's errors against the truth, and whether its covariances are honest."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from proxnav.flight.truth_files import TrueStates
from proxnav.geometry import quaternion
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.navigation.navigator import Judged
from proxnav.records import NAV_STATUSES, NavState


@dataclass(frozen=True, slots=True, eq=False)
class NavErrors:
    """Errors at the instants that have a state; rows of NaN where there is none."""

    t: Float[np.ndarray, "n"]
    range_m: Float[np.ndarray, "n"]
    """True distance from camera to target."""
    errors: Float[np.ndarray, "n 12"]
    """Truth minus estimate, in the blocks of NAV_ERRORS."""
    sigmas: Float[np.ndarray, "n 12"]
    """Claimed standard deviations."""
    nees: Float[np.ndarray, "n"]
    """Normalised squared error of all twelve."""
    status: Int[np.ndarray, "n"]
    """Index into NAV_STATUSES."""

    @property
    def inside_3_sigma(self) -> Float[np.ndarray, "n"]:
        """Share of the twelve errors within three of their claimed deviations."""
        inside = np.abs(self.errors) <= 3.0 * self.sigmas
        return np.where(np.isnan(self.nees), np.nan, inside.mean(axis=1))


def nav_errors(states: Sequence[NavState | None], truth: TrueStates) -> NavErrors:
    """Errors of states that stand at the times of `truth`."""
    n = len(states)
    errors, sigmas, nees = np.full((n, 12), np.nan), np.full((n, 12), np.nan), np.full(n, np.nan)
    status = np.zeros(n, dtype=np.int64)
    for i, state in enumerate(states):
        if state is None:
            continue
        errors[i] = state_error(state, truth, i)
        sigmas[i] = np.sqrt(np.diagonal(state.covariance))
        nees[i] = squared_mahalanobis(errors[i], state.covariance)
        status[i] = NAV_STATUSES.index(state.status)
    return NavErrors(truth.t, np.linalg.norm(truth.r_ric_m, axis=1), errors, sigmas, nees, status)


def state_error(state: NavState, truth: TrueStates, i: int) -> Float[np.ndarray, "12"]:
    """Truth minus estimate; the attitude's error is local: q_true = q * exp(theta / 2)."""
    turn = quaternion.log(quaternion.multiply(quaternion.conjugate(state.q_cam_target), truth.q_cam_target[i]))
    return np.concatenate(
        [truth.r_ric_m[i] - state.r_ric_m, truth.v_ric_mps[i] - state.v_ric_mps, turn,
         truth.rate_target[i] - state.rate_target]
    )  # fmt: skip


def mean_nis(judged: Sequence[Judged], after_s: float) -> dict[str, tuple[float, int]]:
    """Mean normalised innovation per degree of freedom, and the number of accepted readings, by sensor."""
    total: dict[str, list[float]] = {}
    for reading, verdict in judged:
        if verdict.outcome == "accepted" and verdict.dof and reading.t >= after_s:
            row = total.setdefault(reading.sensor, [0.0, 0.0, 0.0])
            row[0], row[1], row[2] = row[0] + verdict.nis, row[1] + verdict.dof, row[2] + 1
    return {sensor: (nis / dof, int(count)) for sensor, (nis, dof, count) in total.items()}


def outcomes(judged: Sequence[Judged]) -> dict[str, dict[str, int]]:
    """How many readings of each sensor met which verdict."""
    counts: dict[str, dict[str, int]] = {}
    for reading, verdict in judged:
        row = counts.setdefault(reading.sensor, {})
        row[verdict.outcome] = row.get(verdict.outcome, 0) + 1
        if verdict.gated_points:
            row["keypoints gated"] = row.get("keypoints gated", 0) + verdict.gated_points
    return counts
