"""Writing a run folder: what was estimated, how wrong it is, and pictures of the best, median and worst frames."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from proxnav.datasets.formats.speed_poses import write_poses
from proxnav.datasets.set.dataset import Dataset
from proxnav.evaluation.judgement import Judgement
from proxnav.evaluation.pairing import PairedFrame, from_best_to_worst
from proxnav.evaluation.run_folder import CONFIG, METRICS, OVERLAYS, POSES, TRUTH, overlay_files, telling
from proxnav.evaluation.run_frames import run_frames_of, write_run_frames
from proxnav.geometry.types import Points
from proxnav.images.codecs import encode_png
from proxnav.records import Keypoints
from proxnav.storage.files import write_atomic, write_json
from proxnav.storage.run_record import run_record
from proxnav.viewing.overlay import caption, overlay
from proxnav.viewing.report import report_html

PICTURES = 10
"""Most frames of a kind that are drawn."""


def write_run(
    out: Path, judgement: Judgement, dataset: Dataset, points_target_m: Points, keypoints: Sequence[Keypoints],
    options: Any,
) -> None:  # fmt: skip
    """poses, truth, metrics, config and frames as .json, and overlays of the best, median and worst frames.

    `keypoints` are those found in each frame of the set, `options` the dataclass that the run was asked with.
    """
    write_poses(out / POSES, judgement.records)
    write_poses(out / TRUTH, judgement.truth)
    write_json(out / METRICS, judgement.metrics(), indent=1)
    write_json(out / CONFIG, run_record(options), indent=1)
    write_run_frames(out, run_frames_of(dataset, points_target_m, keypoints))
    for stale in overlay_files(out / OVERLAYS):
        stale.unlink()
    for name, k in telling(from_best_to_worst(judgement.frames), PICTURES):
        picture = _picture(judgement.frames[k], dataset, k, points_target_m, keypoints[k])
        write_atomic(out / OVERLAYS / name, encode_png(picture))


def write_report(run: Path, title: str, out: Path | None = None) -> Path:
    """Writes a run folder's page to `out`, or as report.html into it; where it was written."""
    page = report_html(run, title)
    path = out or run / "report.html"
    write_atomic(path, page.encode())
    return path


def _picture(
    frame: PairedFrame, dataset: Dataset, k: int, points_target_m: Points, keypoints: Keypoints
) -> UInt8[np.ndarray, "height width rgb=3"]:
    """Frame `k` of the set with what was found in it and what is true."""
    canvas = overlay(dataset.image(k), dataset.camera, frame.T_est, frame.T_true, points_target_m, keypoints)
    found, errors = frame.status, frame.errors
    if errors is not None:
        turn = np.degrees(errors.e_r_rad)
        found = f"E_T {errors.e_t_norm_m:.2f} m, E_R {turn:.2f} deg, E_C {errors.e_c:.4f}"
    return caption(canvas, [f"{frame.filename}  range {frame.range_m:.1f} m", found])
