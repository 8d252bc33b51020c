"""`proxnav benchmark detector`: how long the detector's errors last, measured on frames along the spiral."""

import json
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.benchmarks.error_memory import FrameErrors, PoseError, error_memory, least_squares_pose, pose_memory
from proxnav.cli.progress import progress
from proxnav.cluster.jobs import POOL, check_workers, run_anywhere
from proxnav.commands.estimate_jobs import carried_model
from proxnav.commands.look_jobs import LookJob
from proxnav.errors import InputError
from proxnav.estimator import PoseEstimator
from proxnav.geometry import Pose
from proxnav.geometry.perturbation import difference
from proxnav.geometry.pose_jacobian import pose_jacobian
from proxnav.missions import Mission, load_mission
from proxnav.missions.flights import DAYLIGHT
from proxnav.records import Keypoints, PoseResult, SceneSpec, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.storage.files import write_json
from proxnav.targets.loading import load_target
from proxnav.trajectories import OBSERVATION_10_100_STRICT, select, walking_safety_ellipse
from proxnav.trajectories.selection import observable


@dataclass(frozen=True)
class DetectorBenchmarkConfig:
    """Renders the sunlit spiral 10-100 m, splits the errors of keypoints and poses by how long they last."""

    out: Path
    """Folder: errors.jsonl, a line a frame, from which an interrupted run goes on; detector.json at the end."""
    model: str = "space-rider"
    """Name of a shipped model, or a folder with a model.json."""
    step_s: float = 8.0
    """Between frames..."""
    burst_every_s: float = 400.0
    """... and so often a burst"""
    burst: int = 12
    """of so many frames, one a second."""
    max_phase_deg: float = 90.0
    """Largest angle Sun-target-camera."""
    workers: int = 1
    """Processes; on a Ray cluster, 0 takes every processor."""
    on: str = POOL
    """pool (processes of this machine), ray, or ray://host:port."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""


def run(config: DetectorBenchmarkConfig) -> None:
    """Entry of `proxnav benchmark detector`."""
    if not config.step_s >= 1.0 or not config.burst_every_s >= config.step_s or config.burst < 0:
        raise InputError("--step-s must be at least 1, --burst-every-s at least --step-s and --burst at least 0")
    check_workers(config.workers, config.on)
    scenes = sequence(config)
    job = LookJob(carried_model(config.model, config.on), load_target(PoseEstimator.load(config.model).target))
    if config.dry_run:
        print(dry_run(job, scenes, config))
        return
    path = config.out / "errors.jsonl"
    done_before = _read(path)
    waiting = [scene for scene in scenes if scene.t not in done_before]
    path.parent.mkdir(parents=True, exist_ok=True)
    with progress("detector", len(waiting)) as done, path.open("a", encoding="utf-8") as file:
        points_m = PoseEstimator.load(config.model).points_target_m
        for scene, (keypoints, result) in run_anywhere(job, waiting, config.workers, config.on, _named):
            file.write(json.dumps(_line(scene, keypoints, result, points_m)) + "\n")
            file.flush()
            done()
    write_json(config.out / "detector.json", found := _measured(scenes, _read(path), config), indent=1)
    print(json.dumps(found, indent=1))


def _measured(
    scenes: Sequence[SceneSpec], lines: Mapping[float, dict[str, Any]], config: DetectorBenchmarkConfig
) -> dict[str, Any]:
    statuses = Counter(lines[scene.t]["status"] for scene in scenes)
    solved = [scene for scene in scenes if lines[scene.t]["status"] == "ok"]
    points_m = PoseEstimator.load(config.model).points_target_m
    frames = [_frame(scene, lines[scene.t], points_m) for scene in solved]
    fx = scenes[0].camera.fx
    poses = [_pose(scene, lines[scene.t], points_m) for scene in solved]
    keypoints = {"model": config.model, "statuses": dict(statuses)} | error_memory(frames, fx)
    return keypoints | {"aligned_poses": pose_memory(poses, fx)}


def sequence(config: DetectorBenchmarkConfig) -> list[SceneSpec]:
    """Scenes of the sunlit parts of the spiral at the wanted instants."""
    flight = walking_safety_ellipse(replace(OBSERVATION_10_100_STRICT, step_s=1.0), DAYLIGHT)
    seen = select(flight, observable(flight, np.deg2rad(config.max_phase_deg)))
    since = seen.t - np.maximum.accumulate(np.where(np.diff(seen.t, prepend=-np.inf) > 1.5, seen.t, -np.inf))
    in_burst = since % config.burst_every_s < config.burst
    wanted = select(seen, in_burst | (since % config.step_s < 0.5))
    mission = load_mission("spiral-10-100m")
    options = SceneConfig(sensor=mission.sensor, sequence=wanted.source)
    return [_scene(wanted, k, mission, options) for k in range(len(wanted))]


def _scene(flight: Trajectory, k: int, mission: Mission, options: SceneConfig) -> SceneSpec:
    return scene_at(flight, k, index=k, target=mission.target, camera=mission.camera, config=options, seed=0)


def _line(scene: SceneSpec, keypoints: Keypoints, result: PoseResult, points_m: np.ndarray) -> dict[str, Any]:
    """What is kept of a frame."""
    true_px = scene.camera.project(scene.T_cam_target @ points_m)
    return {
        "t": scene.t, "range_m": float(np.linalg.norm(scene.T_cam_target.t_m)), "status": result.status,
        "error_px": (keypoints.pixels - true_px).tolist(), "cov_px2": keypoints.covariances_px2.tolist(),
        **_pose_error(result, scene.T_cam_target),
    }  # fmt: skip


def _named(scene: SceneSpec) -> str:
    return scene.filename


def dry_run(job: LookJob, scenes: Sequence[SceneSpec], config: DetectorBenchmarkConfig) -> str:
    """Measured on four frames; a line takes 4 kB."""
    from proxnav.commands.dry_run import Estimate, seconds_each

    lanes = max(1, min(config.workers, os.cpu_count() or 1))
    each = seconds_each(job(), scenes[:4])
    return Estimate(each * len(scenes) / lanes, 4e3 * len(scenes)).text(f"{len(scenes)} frames")


def _pose_error(result: PoseResult, T: Pose) -> dict[str, Any]:
    """(dt, dr) from the truth to the found pose and its claimed covariance, both in camera axes."""
    if result.T_cam_target is None or result.covariance is None:
        return {}
    return {"pose_error": difference(T, result.T_cam_target).tolist(), "pose_covariance": result.covariance.tolist()}


def _read(path: Path) -> dict[float, dict[str, Any]]:
    if not path.is_file():
        return {}
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.endswith("}")]
    return {line["t"]: line for line in lines if line["status"] != "ok" or "pose_error" in line}


def _frame(scene: SceneSpec, line: dict[str, Any], points_m: np.ndarray) -> FrameErrors:
    found = np.isfinite(np.array(line["error_px"], dtype=np.float64)[:, 0])
    cov, J = np.array(line["cov_px2"], dtype=np.float64), pose_jacobian(scene.T_cam_target, points_m, scene.camera)
    return FrameErrors(scene.t, line["range_m"], np.array(line["error_px"])[found], cov[found], J[found])


def _pose(scene: SceneSpec, line: dict[str, Any], points_m: np.ndarray) -> PoseError:
    """The pose of a frame, its turn in the target's axes, in which it lasts while the camera turns."""
    A = np.eye(6)
    A[3:, 3:] = scene.T_cam_target.R.T
    error, cov = A @ np.array(line["pose_error"]), A @ np.array(line["pose_covariance"]) @ A.T
    J = pose_jacobian(scene.T_cam_target, points_m, scene.camera)
    of_one_px = np.linalg.inv(np.einsum("kai,kaj->ij", J, J))
    volumes = np.linalg.slogdet(cov)[1] - np.linalg.slogdet(of_one_px)[1]
    step, information = least_squares_pose(_frame(scene, line, points_m))
    return PoseError(
        scene.t,
        line["range_m"],
        error,
        cov,
        float(np.exp(volumes / 12.0)),
        A @ step,
        A @ np.linalg.inv(information) @ A.T,
    )
