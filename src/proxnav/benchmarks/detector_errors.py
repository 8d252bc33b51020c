"""How wrong the estimator is along the sunlit spiral, frame by frame, kept as a line of JSON each."""

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.benchmarks.error_memory import (
    KeypointResiduals,
    PoseResidual,
    error_memory,
    least_squares_pose,
    pose_memory,
)
from proxnav.cluster.jobs import POOL, run_anywhere
from proxnav.cluster.progress import Progress, silent
from proxnav.errors import InputError
from proxnav.estimation import SceneEstimateJob
from proxnav.estimator import PoseEstimator
from proxnav.geometry.perturbation import difference
from proxnav.geometry.pose_jacobian import pose_jacobian
from proxnav.geometry.types import Points
from proxnav.missions import load_mission
from proxnav.missions.flights import DAYLIGHT
from proxnav.models.loading import carried_model
from proxnav.records import Keypoints, PoseResult, SceneSpec
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.storage.files import write_json
from proxnav.targets.loading import load_target
from proxnav.trajectories import OBSERVATION_10_100_STRICT, select, walking_safety_ellipse
from proxnav.trajectories.selection import observable

Line = dict[str, Any]
"""What is kept of a frame: errors_px, cov_px2, and, where there is a pose, pose_error and pose_covariance."""


_BURST_EVERY_S = 400.0
_BURST = 12
"""Frames of a burst, one a second: they show what lasts for seconds."""
_MAX_PHASE_RAD = float(np.deg2rad(90.0))
"""Largest angle Sun-target-camera."""


def measure_detector(
    out: Path, model: str, step_s: float, workers: int = 1, on: str = POOL, progress: Progress = silent
) -> dict[str, Any]:
    """Shares and time constants of the errors, written as `out/detector.json`.

    Every frame is a line of `out/errors.jsonl`, from which an interrupted run goes on.
    """
    estimator, path, scenes = PoseEstimator.load(model), out / "errors.jsonl", sequence(step_s)
    before = _read(path)
    waiting = [scene for scene in scenes if scene.t not in before]
    job = SceneEstimateJob(carried_model(model, on), load_target(estimator.target))
    path.parent.mkdir(parents=True, exist_ok=True)
    with progress("detector", len(waiting)) as done, path.open("a", encoding="utf-8") as file:
        for scene, (keypoints, result) in run_anywhere(job, waiting, workers, on, lambda scene: scene.filename):
            file.write(json.dumps(_line(scene, keypoints, result, estimator.points_target_m)) + "\n")
            file.flush()
            done()
    found = {"model": model} | _measured(scenes, _read(path), estimator.points_target_m)
    write_json(out / "detector.json", found, indent=1)
    return found


def sequence(step_s: float) -> list[SceneSpec]:
    """Scenes of the sunlit parts of the spiral 10-100 m, one every `step_s` and bursts between them."""
    if not 1.0 <= step_s <= _BURST_EVERY_S:
        raise InputError(f"--step-s must be between 1 and {_BURST_EVERY_S:g}, found {step_s:g}")
    flight = walking_safety_ellipse(replace(OBSERVATION_10_100_STRICT, step_s=1.0), DAYLIGHT)
    sunlit = select(flight, observable(flight, _MAX_PHASE_RAD))
    since = sunlit.t - np.maximum.accumulate(np.where(np.diff(sunlit.t, prepend=-np.inf) > 1.5, sunlit.t, -np.inf))
    in_burst = since % _BURST_EVERY_S < _BURST
    wanted = select(sunlit, in_burst | (since % step_s < 0.5))
    mission = load_mission("spiral-10-100m")
    config = SceneConfig(sensor=mission.sensor, sequence=wanted.source)
    make: Callable[[int], SceneSpec] = lambda k: scene_at(  # noqa: E731
        wanted, k, index=k, target=mission.target, camera=mission.camera, config=config, seed=0
    )
    return [make(k) for k in range(len(wanted))]


def _measured(scenes: Sequence[SceneSpec], lines: Mapping[float, Line], points_m: Points) -> dict[str, Any]:
    solved = [scene for scene in scenes if lines[scene.t]["status"] == "ok"]
    frames = [_frame_errors(scene, lines[scene.t], points_m) for scene in solved]
    poses = [_pose_error(scene, lines[scene.t], points_m) for scene in solved]
    statuses, fx = Counter(lines[scene.t]["status"] for scene in scenes), scenes[0].camera.fx
    return {"statuses": dict(statuses)} | error_memory(frames, fx) | {"aligned_poses": pose_memory(poses, fx)}


def _line(scene: SceneSpec, keypoints: Keypoints, result: PoseResult, points_m: Points) -> Line:
    T = scene.T_cam_target
    line: Line = {
        "t": scene.t,
        "range_m": float(np.linalg.norm(T.t_m)),
        "status": result.status,
        "error_px": (keypoints.pixels - scene.camera.project(T @ points_m)).tolist(),
        "cov_px2": keypoints.covariances_px2.tolist(),
    }
    if result.T_cam_target is not None and result.covariance is not None:
        # From the truth to the found pose, with the covariance that it claims; both in camera axes.
        line |= {"pose_error": difference(T, result.T_cam_target).tolist()}
        line |= {"pose_covariance": result.covariance.tolist()}
    return line


def _read(path: Path) -> dict[float, Line]:
    """Whole lines by time [s]; a killed run may have cut the last one."""
    if not path.is_file():
        return {}
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.endswith("}")]
    return {line["t"]: line for line in lines if line["status"] != "ok" or "pose_error" in line}


def _frame_errors(scene: SceneSpec, line: Line, points_m: Points) -> KeypointResiduals:
    errors, covariances = np.array(line["error_px"], np.float64), np.array(line["cov_px2"], np.float64)
    found = np.isfinite(errors[:, 0])
    J = pose_jacobian(scene.T_cam_target, points_m, scene.camera)
    return KeypointResiduals(scene.t, line["range_m"], errors[found], covariances[found], J[found])


def _pose_error(scene: SceneSpec, line: Line, points_m: Points) -> PoseResidual:
    """The pose of a frame, its turn in the target's axes, in which it lasts while the camera turns."""
    A = np.eye(6)
    A[3:, 3:] = scene.T_cam_target.R.T
    covariance = A @ np.array(line["pose_covariance"]) @ A.T
    J = pose_jacobian(scene.T_cam_target, points_m, scene.camera)
    of_one_px = np.linalg.inv(np.einsum("kai,kaj->ij", J, J))
    volumes = np.linalg.slogdet(covariance)[1] - np.linalg.slogdet(of_one_px)[1]
    step, information = least_squares_pose(_frame_errors(scene, line, points_m))
    return PoseResidual(
        t=scene.t,
        range_m=line["range_m"],
        error=A @ np.array(line["pose_error"]),
        covariance=covariance,
        equivalent_px=float(np.exp(volumes / 12.0)),
        keypoint_error=A @ step,
        keypoint_covariance=A @ np.linalg.inv(information) @ A.T,
    )
