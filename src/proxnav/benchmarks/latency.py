"""Image to pose and covariance, frame by frame, beside torchvision's Keypoint R-CNN: milliseconds."""

import time
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import numpy as np

from proxnav.cluster.progress import Progress, silent
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig, FrameJob
from proxnav.geometry.types import Image
from proxnav.missions import Mission
from proxnav.missions.scenes import draw_scenes

Answer = TypeVar("Answer")


def measure_latency(
    models: Sequence[str], mission: Mission, frames: int, reference_frames: int, seed: int,
    backend: Backend = "auto", threads: int = 0, progress: Progress = silent,
) -> dict[str, Any]:  # fmt: skip
    """Milliseconds of each model and of the reference on the same ray-cast frames, and their ratios.

    The reference sees `reference_frames` of them; with 0 it is left out.
    """
    if frames < 2 or reference_frames < 0:
        raise InputError(f"the benchmark needs 2 frames or more, found {frames}")
    make = FrameJob(mission.target, FrameConfig("raycast"))()
    images = [make(scene).image for scene in draw_scenes(mission, frames, seed)]
    rows: dict[str, Any] = {}
    for name in models:
        estimator = PoseEstimator.load(name, backend, threads)
        ms, results = _timed(lambda image, e=estimator: e(image, mission.camera), images, name, progress)
        rows[name] = _row(ms) | {"poses": sum(result.status == "ok" for result in results)}
    if reference_frames:
        from proxnav.detection.keypoint_rcnn.reference import untrained_keypoint_rcnn  # torch, only where it is asked

        ms, _ = _timed(untrained_keypoint_rcnn(threads), images[:reference_frames], "Keypoint R-CNN", progress)
        rows["torchvision keypointrcnn_resnet50_fpn, eager"] = _row(ms)
        for name in models:
            rows[name]["times_faster"] = float(np.median(ms)) / rows[name]["median_ms"]
    return {"frames": frames, "size_px": [mission.camera.width, mission.camera.height], "rows": rows}


def _timed(
    answer: Callable[[Image], Answer], images: Sequence[Image], name: str, progress: Progress
) -> tuple[list[float], list[Answer]]:
    """Milliseconds per image after one image that does not count, and the answers."""
    answer(images[0])
    times, answers = [], []
    with progress(name, len(images)) as done:
        for image in images:
            start = time.perf_counter()
            answers.append(answer(image))
            times.append(1e3 * (time.perf_counter() - start))
            done()
    return times, answers


def _row(ms: Sequence[float]) -> dict[str, float]:
    return {"median_ms": float(np.median(ms)), "p95_ms": float(np.percentile(ms, 95)), "frames": len(ms)}


def table(found: dict[str, Any]) -> str:
    """The rows as text."""
    lines = [f"{'':46s} {'median':>9s} {'p95':>9s} {'faster':>8s}"]
    for name, row in found["rows"].items():
        faster = f"{row['times_faster']:7.1f}x" if "times_faster" in row else ""
        lines.append(f"{name:46s} {row['median_ms']:6.1f} ms {row['p95_ms']:6.1f} ms {faster:>8s}")
    return "\n".join(lines)
