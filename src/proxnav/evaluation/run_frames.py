"""`frames.json` of a run folder: what each frame was and what the detector saw in it, for whoever looks at it later.

{"version": 1, "dataset": folder of the images, relative to the run or null, "target": name or path,
 "epoch_utc": of t_s, "" where the frames are no sequence, "camera": {...}, "keypoints_m": [[x, y, z], ...],
 "frames": [{"filename", "t_s", "phase_deg", "bound_e_t_m", "bound_e_r_deg", "keypoints": [[u, v, score], ...],
             "covariances_px2": [[uu, uv, vv], ...]}, ...]}
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.evaluation.label_bounds import label_bound_errors
from proxnav.geometry import Camera
from proxnav.geometry.arrays import frozen
from proxnav.geometry.camera_record import camera_from_record, camera_record
from proxnav.geometry.types import Points
from proxnav.records import Keypoints
from proxnav.storage.files import inside, read_json, write_json
from proxnav.storage.numbers import finite_numbers

VERSION = 1
NAME = "frames.json"


@dataclass(frozen=True, slots=True, eq=False)
class FrameNote:
    """One frame of a run; NaN where a number is not known."""

    filename: str
    t: float
    """Seconds since the epoch of the sequence; the frame's number where there is none."""
    phase_rad: float
    """Angle Sun, target, camera."""
    bound_e_t_m: float
    """Cramer-Rao bound of E_T (root of the three variances) for the visible keypoints known to 1 px per axis."""
    bound_e_r_rad: float
    """The same of E_R."""
    pixels: Float[np.ndarray, "n_keypoints 2"]
    """Found keypoints [px], NaN where not found."""
    scores: Float[np.ndarray, "n_keypoints"]
    covariances_px2: Float[np.ndarray, "n_keypoints 2 2"]

    def __post_init__(self) -> None:
        n = len(self.pixels)
        object.__setattr__(self, "pixels", frozen(self.pixels, (n, 2), "pixels"))
        object.__setattr__(self, "scores", frozen(self.scores, (n,), "scores"))
        object.__setattr__(self, "covariances_px2", frozen(self.covariances_px2, (n, 2, 2), "covariances_px2"))


@dataclass(frozen=True, slots=True, eq=False)
class RunFrames:
    """The frames of a run and what they share."""

    frames: tuple[FrameNote, ...]
    camera: Camera
    keypoints_m: Points
    """Keypoints in the target frame."""
    target: str
    epoch_utc: str
    """Epoch of `t`; empty where the frames are no sequence in time."""
    dataset: Path | None
    """Folder of the data set; None where it is not there any more."""


def run_frames_of(dataset: Dataset, points_target_m: Points, keypoints: Sequence[Keypoints]) -> RunFrames:
    """What each frame of a data set was: its time, the Sun, the best its keypoints allow, and what was found in it."""
    scenes = list(dataset.scenes()) if (dataset.folder / "scenes.jsonl").is_file() else [None] * len(dataset)
    flown = scenes[0] is not None and bool(scenes[0].sequence)
    notes = [
        FrameNote(
            label.filename,
            scene.t if scene is not None and flown else float(k),
            np.nan if scene is None else scene.phase_rad,
            *label_bound_errors(label, points_target_m, dataset.camera),
            found.pixels,
            found.scores,
            found.covariances_px2,
        )
        for k, (label, scene, found) in enumerate(zip(dataset.labels, scenes, keypoints, strict=True))
    ]
    target = dataset.target_name if scenes[0] is None else scenes[0].target
    epoch = scenes[0].epoch_utc if scenes[0] is not None and flown else ""
    return RunFrames(tuple(notes), dataset.camera, points_target_m, target, epoch, dataset.folder)


def write_run_frames(folder: Path, run: RunFrames) -> None:
    """Writes `frames.json` into a run folder; a data set inside that folder is named relative to it."""
    dataset = run.dataset
    if dataset is not None and dataset.resolve().is_relative_to(folder.resolve()):
        dataset = dataset.resolve().relative_to(folder.resolve())
    content = {
        "version": VERSION,
        "dataset": None if dataset is None else dataset.as_posix(),
        "target": run.target,
        "epoch_utc": run.epoch_utc,
        "camera": camera_record(run.camera),
        "keypoints_m": run.keypoints_m.tolist(),
        "frames": [_entry(frame) for frame in run.frames],
    }
    write_json(folder / NAME, content)


def read_run_frames(folder: Path) -> RunFrames | None:
    """The notes in a run folder; None where an older run has none."""
    path = folder / NAME
    if not path.is_file():
        return None
    content = read_json(path, "what each frame of a run was")
    if not isinstance(content, dict) or content.get("version") != VERSION:
        raise InputError(f"{path}: not of version {VERSION}; make the run again")
    try:
        points = finite_numbers(content["keypoints_m"], None, f"{path}: keypoints_m").reshape(-1, 3)
        return RunFrames(
            tuple(_frame(entry, len(points)) for entry in content["frames"]),
            camera_from_record(content["camera"]),
            points,
            str(content["target"]),
            str(content["epoch_utc"]),
            _dataset(folder, content["dataset"]),
        )
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise InputError(
            f"{path}: incomplete or malformed ({type(error).__name__} {error}); make the run again"
        ) from None


def _dataset(folder: Path, name: Any) -> Path | None:
    if name is None:
        return None
    path = Path(str(name)) if Path(str(name)).is_absolute() else inside(folder, str(name))
    return path if (path / "annotations.json").is_file() or (path / "images").is_dir() else None


def _entry(frame: FrameNote) -> dict[str, Any]:
    cov = frame.covariances_px2
    return {
        "filename": frame.filename,
        "t_s": frame.t,
        "phase_deg": float(np.degrees(frame.phase_rad)),
        "bound_e_t_m": frame.bound_e_t_m,
        "bound_e_r_deg": float(np.degrees(frame.bound_e_r_rad)),
        "keypoints": np.round(np.c_[frame.pixels, frame.scores], 4).tolist(),
        "covariances_px2": np.round(np.c_[cov[:, 0, 0], cov[:, 0, 1], cov[:, 1, 1]], 6).tolist(),
    }


def _frame(entry: Mapping[str, Any], n: int) -> FrameNote:
    points, cov = _table(entry["keypoints"], n), _table(entry["covariances_px2"], n)
    return FrameNote(
        str(entry["filename"]), float(entry["t_s"]), np.radians(_number(entry["phase_deg"])),
        _number(entry["bound_e_t_m"]), np.radians(_number(entry["bound_e_r_deg"])),
        points[:, :2], np.nan_to_num(points[:, 2]), cov[:, [0, 1, 1, 2]].reshape(-1, 2, 2),
    )  # fmt: skip


def _table(rows: Sequence[Any], n: int) -> Float[np.ndarray, "n 3"]:
    """Numbers in rows of three, null as NaN."""
    return np.array(rows, dtype=object).astype(np.float64).reshape(n, 3)


def _number(value: Any) -> float:
    return float("nan") if value is None else float(value)
