"""Errors of many frames in few numbers, with their uncertainty, and the frames without a pose beside them."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.speed_poses import PoseRecord
from proxnav.evaluation.combined_errors import COMBINED
from proxnav.evaluation.pairing import PairedFrame, errors_of, pair
from proxnav.geometry.pose_errors import HALF_TURN_RAD, PoseErrors

RANGE_EDGES_M = (0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 200.0, 400.0, np.inf)
"""Bins of the table by range."""


@dataclass(frozen=True, slots=True, eq=False)
class Summary:
    """Means, medians and percentiles over the frames with a pose; NaN where there is none."""

    frames: int
    poses: int
    mean_e_t_m: tuple[float, float, float]
    """Per camera axis: right, down, forward."""
    mean_e_t_norm_m: float
    mean_e_r_deg: float
    mean_e_tn: float
    mean_e_c: float
    median_e_r_deg: float
    p95_e_r_deg: float
    median_e_t_norm_m: float
    p95_e_t_norm_m: float
    median_e_c: float
    half_turns: int
    """Poses whose attitude error exceeds 90 deg."""
    hazardous: int
    """Poses that would mislead a filter, by size or by the covariance that they claim."""
    intervals: Mapping[str, tuple[float, float]]
    """95 % bootstrap intervals of the means, by the name of the mean."""
    combined: Mapping[str, float]
    """Mean combined error under each named definition."""
    statuses: Mapping[str, int]
    """How many frames ended how; `ok` are the poses."""


def summarise(estimates: Mapping[str, PoseRecord], truth: Mapping[str, PoseRecord]) -> Summary:
    """Errors of estimates against truth, both by file name. Images without an estimate count as frames, not as poses.

    InputError when an estimate has no truth.
    """
    return summarise_frames(pair(estimates, truth))


def summarise_frames(frames: Sequence[PairedFrame]) -> Summary:
    """As `summarise`, of frames that are paired already."""
    errors = errors_of(frames)
    columns = _columns(errors)
    mean = {name: _mean(values) for name, values in columns.items()}
    turn, norm = columns["mean_e_r_deg"], columns["mean_e_t_norm_m"]
    return Summary(
        frames=len(frames),
        poses=len(errors),
        mean_e_t_m=(mean["mean_e_t_x_m"], mean["mean_e_t_y_m"], mean["mean_e_t_z_m"]),
        mean_e_t_norm_m=mean["mean_e_t_norm_m"],
        mean_e_r_deg=mean["mean_e_r_deg"],
        mean_e_tn=mean["mean_e_tn"],
        mean_e_c=mean["mean_e_c"],
        median_e_r_deg=_percentile(turn, 50.0),
        p95_e_r_deg=_percentile(turn, 95.0),
        median_e_t_norm_m=_percentile(norm, 50.0),
        p95_e_t_norm_m=_percentile(norm, 95.0),
        median_e_c=_percentile(columns["mean_e_c"], 50.0),
        half_turns=sum(e.e_r_rad > HALF_TURN_RAD for e in errors),
        hazardous=sum(frame.is_hazardous for frame in frames),
        intervals={name: mean_interval(values) for name, values in columns.items()},
        combined={name: _mean(np.array([score(e) for e in errors])) for name, score in COMBINED.items()},
        statuses=dict(Counter("ok" if frame.errors is not None else frame.status for frame in frames)),
    )


def by_range(
    frames: Sequence[PairedFrame], edges_m: Sequence[float] = RANGE_EDGES_M
) -> dict[tuple[float, float], Summary]:
    """One summary per range bin [edge, next edge) that holds frames."""
    found = {}
    for near, far in pairwise(edges_m):
        inside = [frame for frame in frames if near <= frame.range_m < far]
        if inside:
            found[(float(near), float(far))] = summarise_frames(inside)
    return found


def mean_interval(values: Float[np.ndarray, "n"], resamples: int = 1000, seed: int = 0) -> tuple[float, float]:
    """95 % bootstrap interval of a mean (percentile method); NaN without values."""
    if len(values) == 0:
        return float("nan"), float("nan")
    draws = np.random.default_rng(seed).integers(0, len(values), (resamples, len(values)))
    low, high = np.percentile(values[draws].mean(axis=1), [2.5, 97.5])
    return float(low), float(high)


def _columns(errors: Sequence[PoseErrors]) -> dict[str, Float[np.ndarray, "n"]]:
    e_t_m = np.array([e.e_t_m for e in errors]).reshape(-1, 3)
    return {
        "mean_e_t_x_m": e_t_m[:, 0],
        "mean_e_t_y_m": e_t_m[:, 1],
        "mean_e_t_z_m": e_t_m[:, 2],
        "mean_e_t_norm_m": np.array([e.e_t_norm_m for e in errors]),
        "mean_e_r_deg": np.degrees([e.e_r_rad for e in errors]),
        "mean_e_tn": np.array([e.e_tn for e in errors]),
        "mean_e_c": np.array([e.e_c for e in errors]),
    }


def _mean(values: Float[np.ndarray, "n"]) -> float:
    return float(values.mean()) if len(values) else float("nan")


def _percentile(values: Float[np.ndarray, "n"], percent: float) -> float:
    return float(np.percentile(values, percent)) if len(values) else float("nan")
