"""A replay of any run folder: images with estimates (demo, benchmark table1), or a navigation solution."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from proxnav.datasets.formats.speed_poses import PoseRecord, read_poses
from proxnav.errors import InputError
from proxnav.evaluation.run_folder import CONFIG, MISSION, POSES, SOLUTION, TRUTH
from proxnav.evaluation.run_frames import FrameNote, RunFrames, read_run_frames
from proxnav.evaluation.solution_files import Solution, read_solution
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import R_eci_ric
from proxnav.geometry.perturbation import difference
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.storage.files import inside, read_json
from proxnav.storage.tables import NumberTable, quaternion_columns, read_table, vector_columns
from proxnav.targets import Target
from proxnav.targets.loading import load_target
from proxnav.viewing.replay.replay import Placement, Replay, ReplayStep, position_covariance

CAMERA_AXES = ("right", "down", "forward", "about right", "about down", "about forward")
FLIGHT_AXES = ("radial", "in-track", "cross-track", "about target x", "about target y", "about target z")

Series = Float[np.ndarray, "n"]
Seen = tuple[Float[np.ndarray, "n_keypoints 2"], Float[np.ndarray, "n_keypoints 2 2"]]
"""Keypoints of a frame [px] and their covariances [px^2]; NaN where not found."""


def read_replay(folder: Path, target: str | None = None, every: int = 1) -> Replay:
    """What can be played of a run folder; each `every`-th step. `target` overrides the run's own."""
    if (folder / SOLUTION).is_file():
        replay = _of_flight(folder, target)
    else:
        frames = read_run_frames(folder)
        if frames is None:
            raise InputError(
                f"{folder}: neither frames.json (of demo or benchmark table1) nor solution.csv (of navigate); "
                "give the folder of such a run, or make it again"
            )
        replay = _of_images(folder, frames, target)
    return replace(replay, steps=replay.steps[:: max(1, every)])


def _of_images(folder: Path, run: RunFrames, target: str | None) -> Replay:
    estimates = read_poses(folder / POSES)
    truth = read_poses(folder / TRUTH) if (folder / TRUTH).is_file() else {}
    images = None if run.dataset is None else run.dataset / "images"
    steps = [_image_step(note, estimates.get(note.filename), truth.get(note.filename), images) for note in run.frames]
    mesh = _mesh(target or run.target)
    title = folder.resolve().name
    return Replay(title, "target", run.camera, run.keypoints_m, tuple(steps), CAMERA_AXES, run.epoch_utc, mesh)


def _image_step(
    note: FrameNote, estimate: PoseRecord | None, truth: PoseRecord | None, images: Path | None
) -> ReplayStep:
    T_est = None if estimate is None else estimate.T_cam_target
    T_true = None if truth is None else truth.T_cam_target
    covariance = None if estimate is None or T_est is None else estimate.covariance
    return ReplayStep(
        t=note.t,
        label=note.filename,
        status="missing" if estimate is None else estimate.status,
        truth=_about_target(T_true),
        estimate=_about_target(T_est),
        covariance_m2=None if covariance is None or T_est is None else position_covariance(T_est, covariance),
        pose_covariance=covariance,
        errors=None if T_est is None or T_true is None else difference(T_est, T_true),
        sigmas=None if covariance is None else np.sqrt(np.maximum(np.diagonal(covariance), 0.0)),
        pixels=note.pixels,
        covariances_px2=note.covariances_px2,
        image=None if images is None else inside(images, note.filename),
    )


def _about_target(T_cam_target: Pose | None) -> Placement | None:
    if T_cam_target is None:
        return None
    T = T_cam_target.inverse()
    return Placement(Pose("world", "cam", T.q_wxyz, T.t_m), Pose.identity("world", "target"))


def _of_flight(folder: Path, target: str | None) -> Replay:
    solution = read_solution(folder)
    mesh = _mesh(target or _target_of(folder))
    points = np.zeros((0, 3)) if mesh is None else mesh.keypoints_m
    q_ric_cam = _camera_attitude(folder, solution.t)
    truth = _true_views(folder, solution.t, q_ric_cam)
    seen = _keypoints(folder, solution.t, len(points))
    steps = [_flight_step(solution, k, q_ric_cam[k], truth[k], seen[k]) for k in range(len(solution.t))]
    epoch = str(read_json(folder / "records.json", "the epoch of the records").get("epoch_utc", ""))
    camera = Camera.from_speed_json(folder / "camera.json")
    return Replay(folder.resolve().name, "ric", camera, points, tuple(steps), FLIGHT_AXES, epoch, mesh)


def _flight_step(
    solution: Solution,
    k: int,
    q_ric_cam: QuatWxyz,
    truth: Placement | None,
    seen: Seen | None,
) -> ReplayStep:
    errors = solution.errors[k]
    return ReplayStep(
        t=float(solution.t[k]),
        label=f"t = {solution.t[k]:.1f} s",
        status=solution.status[k],
        truth=truth,
        estimate=_about_ric(q_ric_cam, solution.r_ric_m[k], solution.q_cam_target[k]),
        covariance_m2=solution.covariance_m2[k],
        errors=errors if np.isfinite(errors).all() else None,
        sigmas=solution.sigma[k],
        pixels=None if seen is None else seen[0],
        covariances_px2=None if seen is None else seen[1],
    )


def _about_ric(q_ric_cam: QuatWxyz, r_ric_m: Vector3, q_cam_target: QuatWxyz) -> Placement:
    q_ric_target = quaternion.multiply(q_ric_cam, q_cam_target)
    return Placement(Pose("world", "cam", q_ric_cam, r_ric_m), Pose("world", "target", q_ric_target, np.zeros(3)))


def _camera_attitude(folder: Path, t: Series) -> QuatWxyz:
    """q_ric_cam: the star tracker's reading nearest to each instant, in the axes of the target's orbit."""
    orbit, stars = read_table(folder / "ephemeris.csv"), read_table(folder / "star_tracker.csv")
    R_ric_eci = np.swapaxes(R_eci_ric(_at(t, orbit, "r_eci", "m"), _at(t, orbit, "v_eci", "mps")), -1, -2)
    q_eci_cam = stars.block(*quaternion_columns("q_eci_cam"))[_nearest(stars.column("t_s"), t)]
    return quaternion.multiply(quaternion.from_matrix(R_ric_eci), unit(q_eci_cam))


def _true_views(folder: Path, t: Series, q_ric_cam: QuatWxyz) -> list[Placement | None]:
    """The truth's row nearest to each instant; none without truth.csv."""
    if not (folder / "truth.csv").is_file():
        return [None] * len(t)
    true = read_table(folder / "truth.csv")
    q = true.block(*quaternion_columns("q_cam_target"))[_nearest(true.column("t_s"), t)]
    return [_about_ric(*row) for row in zip(q_ric_cam, _at(t, true, "r_ric", "m"), unit(q), strict=True)]


def _keypoints(folder: Path, t: Series, n: int) -> list[Seen | None]:
    """(pixels, covariances) of the frame nearest to each instant, if one lies within 0.6 s."""
    if n == 0 or not (folder / "keypoints.csv").is_file():
        return [None] * len(t)
    rows = read_table(folder / "keypoints.csv")
    times, frame = np.unique(rows.column("t_s"), return_inverse=True)
    pixels, cov = np.full((len(times), n, 2), np.nan), np.full((len(times), n, 2, 2), np.nan)
    index = rows.column("keypoint").astype(int)
    known = (index >= 0) & (index < n)
    place = (frame[known], index[known])
    pixels[place] = rows.block("u_px", "v_px")[known]
    cov[place] = rows.block(*(f"cov_{k}_px2" for k in ("uu", "uv", "uv", "vv")))[known].reshape(-1, 2, 2)
    near = _nearest(times, t)
    return [(pixels[k], cov[k]) if abs(times[k] - at) < 0.6 else None for k, at in zip(near, t, strict=True)]


def _at(t: Series, table: NumberTable, stem: str, unit_name: str) -> Float[np.ndarray, "n 3"]:
    """Three columns interpolated at `t`."""
    rows = table.block("t_s", *vector_columns(stem, unit_name))
    return np.stack([np.interp(t, rows[:, 0], rows[:, 1 + k]) for k in range(3)], axis=1)


def _nearest(times: Float[np.ndarray, "m"], t: Series) -> Int[np.ndarray, "n"]:
    """Index of the time nearest to each instant."""
    order = np.argsort(times, kind="stable")
    sorted_times = times[order]
    after = np.clip(np.searchsorted(sorted_times, t), 0, len(times) - 1)
    before = np.maximum(after - 1, 0)
    closer = np.abs(sorted_times[before] - t) <= np.abs(sorted_times[after] - t)
    return order[np.where(closer, before, after)]


def _target_of(folder: Path) -> str:
    """The target that the records' mission names, or their configuration; Space Rider where nothing says so."""
    if (folder / MISSION).is_file():
        try:
            return str(tomllib.loads((folder / MISSION).read_text("utf-8")).get("target", "space-rider"))
        except ValueError as error:
            raise InputError(
                f"{folder / MISSION}: not readable as TOML ({error}); remove it to go on without"
            ) from None
    path = folder / CONFIG
    content = read_json(path, "the configuration of a run") if path.is_file() else {}
    options = content.get("options") if isinstance(content, dict) else None
    return str(options.get("target", "space-rider")) if isinstance(options, dict) else "space-rider"


def _mesh(name: str) -> Target | None:
    """The target to draw; None where its file is not there any more."""
    try:
        return load_target(name)
    except InputError:
        return None
