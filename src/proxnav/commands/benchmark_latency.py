"""`proxnav benchmark latency`: image to pose and covariance, frame by frame, beside torchvision's Keypoint R-CNN."""

import json
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.cli.progress import progress
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.frames import FrameConfig, FrameJob
from proxnav.missions import load_mission
from proxnav.missions.scenes import draw_scenes
from proxnav.storage.files import write_json


@dataclass(frozen=True)
class LatencyConfig:
    """Frames of the mission, ray-cast, seen by each model and by the reference in turn."""

    models: tuple[str, ...] = ("space-rider-fast", "space-rider")
    """Names or folders."""
    frames: int = 20
    seed: int = 300
    preset: str = "observation-10-100m"
    backend: Backend = "auto"
    threads: int = 0
    """Of every runtime; 0 takes all cores."""
    reference_frames: int = 5
    """Frames that the reference sees; it takes seconds for each. 0 leaves it out."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    json: bool = False
    """Print JSON instead of a table."""
    out: Path | None = None
    """Folder for latency.json."""


def run(config: LatencyConfig) -> None:
    """Entry of `proxnav benchmark latency`."""
    if config.frames < 2 or config.reference_frames < 0:
        raise InputError(f"the benchmark needs 2 frames or more, found {config.frames}")
    if config.dry_run:
        print(dry_run(config))
        return
    found = measure(config)
    if config.out is not None:
        write_json(config.out / "latency.json", found, indent=1)
    print(json.dumps(found, indent=1) if config.json else table(found))


def measure(config: LatencyConfig) -> dict[str, Any]:
    """Milliseconds of each model and of the reference, and their ratios."""
    mission = load_mission(config.preset)
    scenes = draw_scenes(mission, config.frames, config.seed)
    make = FrameJob(mission.target, FrameConfig("raycast"))()
    images = [make(scene).image for scene in scenes]
    rows: dict[str, Any] = {}
    for name in config.models:
        estimator = PoseEstimator.load(name, config.backend, config.threads)
        ms, results = _timed(lambda image, e=estimator: e(image, mission.camera), images, name)
        rows[name] = _row(ms) | {"poses": sum(result.status == "ok" for result in results)}
    if config.reference_frames:
        see = keypoint_rcnn(config.threads)
        ms, _ = _timed(see, images[: config.reference_frames], "Keypoint R-CNN")
        rows["torchvision keypointrcnn_resnet50_fpn, eager"] = _row(ms)
        for name in config.models:
            rows[name]["times_faster"] = float(np.median(ms)) / rows[name]["median_ms"]
    return {"frames": config.frames, "size_px": [mission.camera.width, mission.camera.height], "rows": rows}


def dry_run(config: LatencyConfig) -> str:
    """Measured on three frames of each model and one of the reference; both see their first frame twice."""
    from proxnav.commands.dry_run import Estimate

    few = replace(config, frames=3, reference_frames=min(config.reference_frames, 1))
    rows, seconds = measure(few)["rows"], 0.0
    for name, row in rows.items():
        frames = config.frames if name in config.models else config.reference_frames
        seconds += row["median_ms"] / 1e3 * (frames + 1)
    return Estimate(seconds, 2e3).text(f"{config.frames} frames seen by {len(rows)} networks")


def keypoint_rcnn(threads: int) -> Callable[[np.ndarray], Any]:
    """torchvision's Keypoint R-CNN with six keypoints as it comes: float32, eager, 800 px, weights drawn at random.

    Untrained it proposes as many boxes as a trained one, but keeps fewer of them for the keypoint head: the ratio errs
    on the side of the reference.
    """
    import torch
    from torchvision.models.detection import keypointrcnn_resnet50_fpn

    if threads:
        torch.set_num_threads(threads)
    net = keypointrcnn_resnet50_fpn(weights=None, weights_backbone=None, num_keypoints=6).eval()

    def see(image: np.ndarray) -> Any:
        colour = torch.from_numpy(image).float().div(255.0).expand(3, -1, -1)
        with torch.inference_mode():
            return net([colour])

    return see


def _timed(see: Callable[[np.ndarray], Any], images: list[np.ndarray], name: str) -> tuple[list[float], list[Any]]:
    """Milliseconds per image after one image that does not count, and what was seen."""
    see(images[0])
    times, results = [], []
    with progress(name, len(images)) as done:
        for image in images:
            start = time.perf_counter()
            results.append(see(image))
            times.append(1e3 * (time.perf_counter() - start))
            done()
    return times, results


def _row(ms: list[float]) -> dict[str, float]:
    return {"median_ms": float(np.median(ms)), "p95_ms": float(np.percentile(ms, 95)), "frames": len(ms)}


def table(found: dict[str, Any]) -> str:
    """The rows as text."""
    lines = [f"{'':46s} {'median':>9s} {'p95':>9s} {'faster':>8s}"]
    for name, row in found["rows"].items():
        faster = f"{row['times_faster']:7.1f}x" if "times_faster" in row else ""
        lines.append(f"{name:46s} {row['median_ms']:6.1f} ms {row['p95_ms']:6.1f} ms {faster:>8s}")
    return "\n".join(lines)
