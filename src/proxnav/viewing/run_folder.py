"""A run folder as values that can be shown: one row per frame, the headline numbers, the pictures, the configuration.

poses.json    estimates               metrics.json   headline numbers
truth.json    true poses              overlays/      <best|median|worst>-NNNN.png, NNNN = place from best to worst
config.json   optional, what was asked for and with which versions
frames.json   optional, phase angle and Cramer-Rao bound of each frame
solution.csv  a navigation solution, alone or beside the rest
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses
from proxnav.errors import InputError
from proxnav.evaluation.run_frames import FrameNote, read_run_frames
from proxnav.geometry import Pose, quaternion, so3
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.storage.files import read_json
from proxnav.viewing.flight_folder import SOLUTION, Flight, read_flight

_OVERLAY = re.compile(r"(best|median|worst)-(\d{1,9})\.png")

HALF_TURN_RAD = np.pi / 2.0
"""An attitude this wrong took one side of the target for another."""


@dataclass(frozen=True, slots=True, eq=False)
class FrameErrors:
    """Errors of one estimate of T_cam_target, as docs/conventions.md defines them."""

    e_t_m: np.ndarray
    """(3,) absolute position error per camera axis: right, down, forward."""
    e_t_norm_m: float
    e_tn: float
    """Norm over the true range."""
    e_r_rad: float
    e_c: float
    """E_TN + E_R [rad]."""
    normalised: np.ndarray | None
    """(6,) signed errors (translation, rotation) over their claimed standard deviations, if a covariance is claimed."""
    nees: float | None
    """Squared Mahalanobis length of the error under the claimed covariance; infinite where that is not positive."""


@dataclass(frozen=True, slots=True, eq=False)
class FrameRow:
    """One image of the truth."""

    filename: str
    range_m: float
    status: str
    """`ok`, or why there is no pose; `missing` where the estimates do not know the image."""
    errors: FrameErrors | None = None


@dataclass(frozen=True, slots=True)
class Picture:
    """An overlay on disk and what it shows."""

    path: Path
    rank: str
    """best, median or worst."""
    place: int
    """Place of the frame from best (0) to worst."""


@dataclass(frozen=True, slots=True, eq=False)
class Run:
    """What a report shows."""

    frames: tuple[FrameRow, ...]
    metrics: Mapping[str, Any]
    pictures: tuple[Picture, ...]
    """From worst to best."""
    config: Any = None
    notes: Mapping[str, FrameNote] = field(default_factory=dict)
    """What each frame was, by file name; empty where the run does not say."""
    flight: Flight | None = None
    """Navigation solution, if the run has one."""


def read_run(folder: Path) -> Run:
    """The run in `folder`; InputError names what is missing or does not fit."""
    config = folder / "config.json"
    configuration = read_json(config, "the configuration of a run") if config.is_file() else None
    flight = read_flight(folder) if (folder / SOLUTION).is_file() else None
    if flight is not None and not (folder / "poses.json").is_file():
        return Run((), {}, (), configuration, flight=flight)
    metrics = read_json(folder / "metrics.json", "the headline numbers of a run")
    if not isinstance(metrics, dict):
        raise InputError(f"{folder / 'metrics.json'}: expected one object of numbers; run proxnav evaluate again")
    notes = read_run_frames(folder)
    return Run(
        frames=frame_rows(read_poses(folder / "poses.json"), read_poses(folder / "truth.json")),
        metrics=metrics,
        pictures=_pictures(folder / "overlays"),
        config=configuration,
        notes={} if notes is None else {note.filename: note for note in notes.frames},
        flight=flight,
    )


def frame_rows(estimates: Mapping[str, PoseRecord], truth: Mapping[str, PoseRecord]) -> tuple[FrameRow, ...]:
    """One row per image of the truth, in its order; InputError for an estimate that the truth lacks."""
    extra = [name for name in estimates if name not in truth]
    if extra:
        raise InputError(f"{len(extra)} estimates, first {extra[0]!r}, have no truth; check that both are of one set")
    return tuple(_row(record, estimates.get(name)) for name, record in truth.items())


def from_best_to_worst(frames: tuple[FrameRow, ...]) -> list[FrameRow]:
    """Frames by E_C; those without a pose last."""
    return sorted(frames, key=lambda frame: np.inf if frame.errors is None else frame.errors.e_c)


def frame_errors(T_est: Pose, T_true: Pose, covariance: Float[np.ndarray, "6 6"] | None = None) -> FrameErrors:
    """Errors of an estimate, and how they compare with the covariance it claims."""
    difference = np.concatenate([T_true.t_m - T_est.t_m, so3.log(T_true.R @ T_est.R.T)])
    norm, range_m = float(np.linalg.norm(difference[:3])), float(np.linalg.norm(T_true.t_m))
    turn = float(quaternion.angle_between(T_est.q_wxyz, T_true.q_wxyz))
    normalised = nees = None
    if covariance is not None:
        sigma = np.sqrt(np.maximum(np.diagonal(covariance), 1e-300))
        normalised, nees = difference / sigma, float(squared_mahalanobis(difference, covariance))
    return FrameErrors(np.abs(difference[:3]), norm, norm / range_m, turn, norm / range_m + turn, normalised, nees)


def _row(truth: PoseRecord, estimate: PoseRecord | None) -> FrameRow:
    if truth.T_cam_target is None or not np.any(truth.T_cam_target.t_m):
        raise InputError(f"the truth has no pose at a range above 0 m for {truth.filename!r}; remove the image")
    range_m = float(np.linalg.norm(truth.T_cam_target.t_m))
    if estimate is None or estimate.T_cam_target is None:
        return FrameRow(truth.filename, range_m, "missing" if estimate is None else estimate.status)
    errors = frame_errors(estimate.T_cam_target, truth.T_cam_target, estimate.covariance)
    return FrameRow(truth.filename, range_m, estimate.status, errors)


def overlay_files(folder: Path) -> list[Path]:
    """The overlays in a folder, by name; files of other names are none of ours."""
    return sorted(path for path in folder.glob("*.png") if _OVERLAY.fullmatch(path.name))


def _pictures(folder: Path) -> tuple[Picture, ...]:
    """Overlays from worst to best."""
    named = [(path, _OVERLAY.fullmatch(path.name)) for path in overlay_files(folder)]
    found = [Picture(path, match[1], int(match[2])) for path, match in named if match]
    return tuple(sorted(found, key=lambda picture: -picture.place))
