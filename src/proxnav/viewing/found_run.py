"""A run folder of images whose truth nobody knows: poses, frames, the images, and pictures of what was found."""

import os
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.datasets.formats.speed_poses import PoseRecord, write_poses
from proxnav.errors import InputError
from proxnav.evaluation.run_folder import CONFIG, OVERLAYS, POSES, TRUTH
from proxnav.evaluation.run_frames import FrameNote, RunFrames, write_run_frames
from proxnav.geometry import Camera
from proxnav.geometry.types import Points
from proxnav.images.codecs import encode_png, read_image
from proxnav.records import Keypoints
from proxnav.storage.files import write_atomic, write_json
from proxnav.storage.run_record import run_record
from proxnav.viewing.overlay import caption, overlay

_AXIS_SHARE = 0.1
"""Length of the drawn axes over the range."""


@dataclass(frozen=True, slots=True, eq=False)
class Found:
    """What an estimator found in images, in their order."""

    images: Sequence[Path]
    camera: Camera
    records: Sequence[PoseRecord]
    keypoints: Sequence[Keypoints]
    keypoints_m: Points
    """Keypoints of the model, target frame."""
    target: str


def check_found_run(folder: Path) -> None:
    """InputError where the folder is a run with a truth of its own: to be asked before the work."""
    if folder.is_file() or (folder / TRUTH).exists():
        raise InputError(f"--run {folder}: is a file, or a run whose truth is known; give another folder")


def write_found_run(folder: Path, found: Found, options: Any) -> None:
    """poses.json, frames.json, config.json, images/ and overlays/; `options` is what the run was asked with."""
    write_poses(folder / POSES, found.records)
    write_json(folder / CONFIG, run_record(options), indent=1)
    notes = tuple(_note(k, path, one) for k, (path, one) in enumerate(zip(found.images, found.keypoints, strict=True)))
    (folder / "images").mkdir(parents=True, exist_ok=True)
    write_run_frames(folder, RunFrames(notes, found.camera, found.keypoints_m, found.target, "", folder))
    for path, record, keypoints in zip(found.images, found.records, found.keypoints, strict=True):
        _link(path, folder / "images" / path.name)
        _draw(folder / OVERLAYS / f"{path.stem}.png", path, found.camera, record, keypoints)


def _note(k: int, path: Path, found: Keypoints) -> FrameNote:
    nan = float("nan")
    return FrameNote(path.name, float(k), nan, nan, nan, found.pixels, found.scores, found.covariances_px2)


def _link(source: Path, place: Path) -> None:
    place.unlink(missing_ok=True)
    try:
        os.link(source.resolve(), place)
    except OSError:  # another disk, or a file system without links
        shutil.copyfile(source, place)


def _draw(place: Path, path: Path, camera: Camera, record: PoseRecord, found: Keypoints) -> None:
    """Keypoints with their ellipses, axes of the target, range or the status; nothing of an unreadable image."""
    try:
        image = read_image(path)
    except InputError:
        return
    T = record.T_cam_target
    range_m = 0.0 if T is None else float(np.linalg.norm(T.t_m))
    canvas = overlay(image, camera, T, None, None, found, max(_AXIS_SHARE * range_m, 1e-3))
    said = record.status if T is None else f"range {range_m:.2f} m, {_deviations(record)}"
    write_atomic(place, encode_png(caption(canvas, [path.name, said])))


def _deviations(record: PoseRecord) -> str:
    if record.covariance is None:
        return "no covariance"
    sigma = np.sqrt(np.diagonal(record.covariance))
    return f"1 sigma {np.linalg.norm(sigma[:3]):.3g} m, {np.degrees(np.linalg.norm(sigma[3:])):.2g} deg"
