"""One simulated flight through the filter, and many of them together: are the covariances honest, how good is it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

import numpy as np
from jaxtyping import Float, Int
from scipy.stats import chi2

from proxnav.evaluation.navigation_errors import mean_nis, nav_errors
from proxnav.flight.faults import Fault, with_fault
from proxnav.flight.simulate import SimulationConfig, simulate
from proxnav.flight.truth import Truth
from proxnav.flight.truth_files import true_states
from proxnav.geometry import Camera, quaternion
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.navigator import run_filter
from proxnav.records import NAV_ERRORS, NAV_STATUSES, SensorRecords, Trajectory
from proxnav.storage.run_record import plain
from proxnav.targets import Target
from proxnav.targets.loading import load_target

EVERY_S = 5.0
"""Between the instants at which a run is judged."""
_TRACKING = NAV_STATUSES.index("tracking")
_END_S = 120.0


@dataclass(frozen=True)
class Case:
    """One run to be."""

    name: str
    seed: int
    fault: Fault = "none"


@dataclass(frozen=True)
class RunResult:
    """How it went, every `EVERY_S` seconds, as `NavErrors` has it."""

    range_m: Float[np.ndarray, "n"]
    errors: Float[np.ndarray, "n 12"]
    sigmas: Float[np.ndarray, "n 12"]
    nees: Float[np.ndarray, "n"]
    status: Int[np.ndarray, "n"]
    nis: dict[str, tuple[float, int]]
    """Mean normalised innovation per degree of freedom, and how many, by sensor."""
    single_position_m: float
    """Root mean square position error of the single frames' poses over the second half [m]."""
    single_attitude_rad: float
    starts: int


class Job(Protocol):
    """What builds, once per process, the function that runs cases. Can be pickled."""

    def __call__(self) -> Callable[[Case], RunResult]: ...

    @property
    def options(self) -> dict[str, Any]:
        """All that tells its runs from those of another job."""
        ...


@dataclass(frozen=True)
class RunJob:
    """Builds, once per process, the function that runs cases. Can be pickled."""

    reference: Trajectory
    duration_s: float
    """Each run flies so long a piece of the reference, begun anywhere."""
    target: str
    camera: Camera
    simulation: SimulationConfig
    filter: NavigationConfig

    def __call__(self) -> Callable[[Case], RunResult]:
        return lambda case: run_case(case, self)

    @property
    def options(self) -> dict[str, Any]:
        """All that tells its runs from those of another job."""
        return {"seconds": self.duration_s, "target": self.target,
                "flight": [len(self.reference), self.reference.source], "simulation": plain(self.simulation),
                "filter": plain(self.filter)}  # fmt: skip


def run_case(case: Case, job: RunJob) -> RunResult:
    """Simulates, breaks, filters, compares."""
    rng = np.random.default_rng((case.seed, 20241101))
    target = load_target(job.target)
    truth, clean = simulate(piece(job, rng), target, job.camera, job.simulation, rng)
    found = judged_run(truth, with_fault(clean, case.fault, rng), target, job.camera, job.filter)
    position, attitude = _single_frames(truth, clean)
    return replace(found, single_position_m=position, single_attitude_rad=attitude)


def judged_run(
    truth: Truth, records: SensorRecords, target: Target, camera: Camera, config: NavigationConfig
) -> RunResult:
    """The filter over these records, compared with the truth; nothing is said of single frames."""
    setup = setup_of(records, target.keypoints_m, camera, config)
    t = np.arange(truth.t[0] + EVERY_S, truth.t[-1], EVERY_S)
    states, judged, last = run_filter(records, setup, t)
    found = nav_errors(states, true_states(truth).at(t))
    nis = mean_nis(judged, float(truth.t[0]) + 60.0)
    return RunResult(
        found.range_m, found.errors, found.sigmas, found.nees, found.status, nis, np.nan, np.nan, last.memory.starts
    )


def summarise(results: Sequence[RunResult]) -> dict[str, Any]:
    """Consistency and accuracy of many runs of the same length."""
    nees = np.array([r.nees for r in results])
    errors, sigmas = np.array([r.errors for r in results]), np.array([r.sigmas for r in results])
    runs, settled = len(results), slice(nees.shape[1] // 2, None)
    low, high = chi2.ppf([0.025, 0.975], 12 * runs) / runs
    mean = np.nanmean(nees, axis=0)
    inside = np.abs(errors) <= 3.0 * sigmas
    late, ranges = errors[:, settled], np.array([r.range_m for r in results])[:, settled]
    return {
        "runs": runs,
        "mean_nees_of_12": float(np.nanmean(nees)),
        "nees_interval_95": [float(low), float(high)],
        "share_of_time_inside": float(np.mean((mean >= low) & (mean <= high))),
        "share_of_time_not_above": float(np.mean(mean <= high)),
        "inside_3_sigma": float(inside[np.isfinite(errors)].mean()),
        "nis": _mean_nis(results),
        "starts": int(sum(r.starts for r in results)),
        **_accuracy(late, ranges),
        "single_frame_position_m": float(np.sqrt(np.mean([r.single_position_m**2 for r in results]))),
        "single_frame_attitude_deg": float(np.rad2deg(np.sqrt(np.mean([r.single_attitude_rad**2 for r in results])))),
    }


def honesty(results: Sequence[RunResult]) -> dict[str, Any]:
    """The columns of `summarise` that say whether covariances are honest, and the accuracy of the second half."""
    whole = summarise(results)
    names = ("runs", "mean_nees_of_12", "inside_3_sigma", "starts", "nis", "rms_position_m", "rms_attitude_deg")
    return {name: whole[name] for name in names}


def judge_fault(results: Sequence[RunResult]) -> dict[str, Any]:
    """How runs with a fault end: inside three sigma, or saying that they are not, or neither."""
    beyond, bound = 0, float(chi2.ppf(0.9999, 12))
    inside, says, peaks = 0, 0, []
    count = round(_END_S / EVERY_S)
    for r in results:
        healthy = bool(np.isfinite(r.nees[-1]) and np.nanmean(r.nees[-count:]) < bound)
        silent = bool((r.status[-count:] == _TRACKING).all())
        inside += healthy
        says += not healthy and not silent
        beyond += not healthy and silent
        peaks.append(float(np.nanmax(np.linalg.norm(r.errors[:, NAV_ERRORS.position], axis=1))))
    whole = summarise(results)
    return {
        "runs": len(results), "end_inside": inside, "end_outside_and_said": says, "end_outside_unnoticed": beyond,
        "silent_outside_share": _silent_outside(results), "inside_3_sigma": whole["inside_3_sigma"],
        "largest_position_error_m": max(peaks), "median_largest_position_error_m": float(np.median(peaks)),
        "restarts": whole["starts"] - len(results), "mean_nees_of_12": whole["mean_nees_of_12"],
    }  # fmt: skip


def _silent_outside(results: Sequence[RunResult]) -> float:
    """Share of instants with status `tracking` whose error is beyond what one honest instant in 10 000 shows."""
    nees = np.concatenate([r.nees for r in results])
    tracking = np.concatenate([r.status for r in results]) == _TRACKING
    return float((nees[tracking] > chi2.ppf(0.9999, 12)).mean())


def _accuracy(errors: Float[np.ndarray, "runs n 12"], ranges: Float[np.ndarray, "runs n"]) -> dict[str, Any]:
    """Root mean squares over the second half of the runs."""
    position, velocity, turn = (
        np.linalg.norm(errors[..., block], axis=-1)
        for block in (NAV_ERRORS.position, NAV_ERRORS.velocity, NAV_ERRORS.attitude)
    )
    near = ranges < 30.0
    return {
        "rms_position_m": _rms(position),
        "rms_position_share_of_range": _rms(position / ranges),
        "rms_position_inside_30_m": _rms(position[near]) if near.any() else None,
        "rms_velocity_mps": _rms(velocity),
        "rms_attitude_deg": float(np.rad2deg(_rms(turn))),
        "rms_attitude_inside_30_m_deg": float(np.rad2deg(_rms(turn[near]))) if near.any() else None,
    }


def _mean_nis(results: Sequence[RunResult]) -> dict[str, float]:
    kinds = sorted({kind for r in results for kind in r.nis})
    return {
        kind: float(np.average([r.nis[kind][0] for r in results if kind in r.nis],
                               weights=[r.nis[kind][1] for r in results if kind in r.nis]))
        for kind in kinds
    }  # fmt: skip


def piece(job: RunJob, rng: np.random.Generator) -> Trajectory:
    """`duration_s` of the reference from a random instant."""
    t = job.reference.t
    first = rng.uniform(t[0], max(t[-1] - job.duration_s, t[0]))
    k = np.flatnonzero((t >= first - 1e-9) & (t <= first + job.duration_s + 1e-9))
    names = [name for name in job.reference.__dataclass_fields__ if name not in ("epoch_utc", "source")]
    return replace(job.reference, **{name: getattr(job.reference, name)[k] for name in names})


def _single_frames(truth: Truth, records: SensorRecords) -> tuple[float, float]:
    """RMS position and attitude error of the poses over the second half."""
    p = records.poses
    if p is None:
        return float("nan"), float("nan")
    late = p.t > 0.5 * (truth.t[0] + truth.t[-1])
    k = np.round((p.t[late] - truth.t[0]) / truth.step_s).astype(int)
    position = np.linalg.norm(p.t_cam_target_m[late] - truth.t_cam_target_m[k], axis=1)
    turn = np.asarray(quaternion.angle_between(p.q_cam_target[late], truth.q_cam_target[k]))
    return _rms(position), _rms(turn)


def _rms(values: Float[np.ndarray, "..."]) -> float:
    return float(np.sqrt(np.nanmean(np.square(values))))
