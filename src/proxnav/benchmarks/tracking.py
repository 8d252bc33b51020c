"""The tracker without a network on ray-cast sequences: frames that it holds, frames it skips, starts that are off."""

import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.benchmarks.tracking_flights import TUMBLE_DEG_S, Motion, tracking_scenes
from proxnav.cluster.progress import Progress, silent
from proxnav.datasets.set.dataset import Dataset
from proxnav.errors import InputError
from proxnav.frames import FrameConfig
from proxnav.geometry import Camera, Pose
from proxnav.geometry.arrays import unit
from proxnav.geometry.perturbation import moved
from proxnav.geometry.pose_errors import pose_errors
from proxnav.pose.track import Start, Tracker
from proxnav.records import PoseResult
from proxnav.rendered_set import render
from proxnav.targets import Target
from proxnav.targets.loading import load_target

WITHIN_SHARE, WITHIN_RAD = 0.02, float(np.deg2rad(2.0))
"""Errors of place over range and of attitude up to which a frame counts as tracked."""
_FOV_PX = 1407.0 / 1024.0
"""Focal length of the navigation camera over its width."""
_PLACE_PER_DEG = np.array([0.001, 0.001, 0.004])
"""Error of a first place as a share of the range, for each degree of attitude."""


@dataclass(frozen=True, slots=True)
class TrackPlan:
    """What is measured."""

    frames: int
    size_px: int
    every: tuple[int, ...]
    """Takes every n-th frame, for each of these."""
    errors_deg: tuple[float, ...]
    """Errors of the first attitude."""
    starts: int
    """Starts for each error, spread over the sequence."""
    start_frames: int
    """Frames that each of them runs."""
    seed: int


@dataclass(frozen=True, slots=True)
class _Run:
    """What became of each frame."""

    held: list[bool]
    given: list[bool]
    """Whether there was a pose."""
    ms: list[float]

    def row(self) -> dict[str, float]:
        """Shares of the frames, and milliseconds."""
        held, given = np.array(self.held), np.array(self.given)
        return {
            "frames": len(held), "within": float(held.mean()), "no_pose": float(1.0 - given.mean()),
            "wrong": float((given & ~held).mean()), "median_ms": float(np.median(self.ms)),
            "mean_ms": float(np.mean(self.ms)),
        }  # fmt: skip


def measure_tracking(
    targets: Sequence[str], motions: Sequence[Motion], plan: TrackPlan, folder: Path, progress: Progress = silent
) -> dict[str, Any]:
    """Tables by target and motion; the frames stay in `folder`, so that a second call does not draw them again."""
    if plan.frames < 2 * max(plan.every) or plan.starts < 0:
        raise InputError(f"--frames must be at least {2 * max(plan.every)}, twice the largest --every")
    f = _FOV_PX * plan.size_px
    camera = Camera(plan.size_px, plan.size_px, f, f, 0.5 * plan.size_px, 0.5 * plan.size_px)
    rows: dict[str, Any] = {}
    for name in targets:
        target = load_target(name)
        for motion in motions:
            scenes = tracking_scenes(motion, target, name, camera, plan.frames, plan.seed)
            kind = f"{target.name} {motion}"
            with progress(f"render {kind}", len(scenes)) as done:
                where = folder / f"{target.name}-{motion}-{plan.frames}-{plan.size_px}"
                frames = render(scenes, FrameConfig("raycast"), where, 1, done)
            times = [scene.t for scene in scenes]
            with progress(f"track {kind}", len(plan.every) + len(plan.errors_deg)) as done:
                rows[kind] = _measured(target, frames, times, plan, done)
    return {"frames": plan.frames, "size_px": plan.size_px, "tumble_deg_s": list(TUMBLE_DEG_S), "rows": rows}


def _measured(target: Target, frames: Dataset, times: list[float], plan: TrackPlan, done: Any) -> dict[str, Any]:
    found: dict[str, Any] = {"every": {}, "start_error_deg": {}}
    for every in plan.every:
        places = range(0, len(frames), every)
        found["every"][str(every)] = _followed(target, frames, times, places, 2.0, plan.seed).row()
        done()
    for error in plan.errors_deg:
        firsts = np.linspace(0, len(frames) - plan.start_frames, plan.starts).astype(int).tolist()
        runs = [_followed(target, frames, times, range(k, k + plan.start_frames), error, plan.seed + k) for k in firsts]
        found["start_error_deg"][f"{error:g}"] = {
            "starts": len(runs),
            "held_at_the_end": float(np.mean([run.held[-1] for run in runs])),
            "wrong_at_the_end": float(np.mean([run.given[-1] and not run.held[-1] for run in runs])),
            "within": float(np.mean([run.held for run in runs])),
            "first_frame_ms": float(np.median([run.ms[0] for run in runs])),
        }
        done()
    return found


def _followed(target: Target, frames: Dataset, times: list[float], places: range, error_deg: float, seed: int) -> _Run:
    """The tracker from a start that is `error_deg` off about a random axis, and displaced in that proportion."""
    start = _off(frames.labels[places[0]].T_cam_target, error_deg, np.random.default_rng(seed))
    sigma = Start(float(np.deg2rad(max(error_deg, 1.0) / 1.7)), max(0.004 * error_deg, 0.01))
    tracker, run = Tracker.from_pose(target, start, times[places[0]], sigma), _Run([], [], [])
    for k in places:
        image = frames.image(k)
        begun = time.perf_counter()
        result = tracker(image, frames.camera, times[k])
        run.ms.append(1e3 * (time.perf_counter() - begun))
        run.given.append(result.T_cam_target is not None)
        run.held.append(_is_within(result, frames.labels[k].T_cam_target))
    return run


def _off(T: Pose, error_deg: float, rng: np.random.Generator) -> Pose:
    turn = np.deg2rad(error_deg) * unit(rng.normal(size=3))
    shift = rng.normal(size=3) * _PLACE_PER_DEG * error_deg * float(np.linalg.norm(T.t_m))
    return moved(T, np.concatenate([shift, turn]))


def _is_within(result: PoseResult, T_true: Pose) -> bool:
    if result.T_cam_target is None:
        return False
    errors = pose_errors(result.T_cam_target, T_true)
    return errors.e_tn < WITHIN_SHARE and errors.e_r_rad < WITHIN_RAD


def table(found: dict[str, Any]) -> str:
    """The rows as text."""
    lines = [f"{found['frames']} frames of {found['size_px']} px each; tracked: within 2 % of range and 2 deg", ""]
    lines.append(f"{'':26s} {'every':>5s} {'tracked':>8s} {'no pose':>8s} {'wrong':>7s} {'median':>8s} {'mean':>8s}")
    for name, row in found["rows"].items():
        for every, one in row["every"].items():
            shares = f"{one['within']:8.1%} {one['no_pose']:8.1%} {one['wrong']:7.1%}"
            lines.append(f"{name:26s} {every:>5s} {shares} {one['median_ms']:5.0f} ms {one['mean_ms']:5.0f} ms")
    lines += ["", f"{'':26s} {'start off':>9s} {'starts':>6s} {'held at the end':>16s} {'wrong at the end':>17s}"]
    for name, row in found["rows"].items():
        for error, one in row["start_error_deg"].items():
            held, wrong = one["held_at_the_end"], one["wrong_at_the_end"]
            lines.append(f"{name:26s} {error:>5s} deg {one['starts']:6d} {held:16.0%} {wrong:17.0%}")
    return "\n".join(lines)
