"""The model's errors under each condition, and what frames without a target give."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from proxnav.benchmarks.conditions import Change, conditions, is_before_earth
from proxnav.cluster.jobs import POOL, run_anywhere
from proxnav.cluster.progress import Progress, silent
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.estimation import SceneEstimateJob
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference
from proxnav.geometry.pose_errors import pose_errors
from proxnav.missions import Mission
from proxnav.missions.views import accepted_views
from proxnav.models.loading import carried_model
from proxnav.records import PoseResult, SceneSpec
from proxnav.scenes.random_scene import RandomSceneConfig, random_scene
from proxnav.targets.loading import load_target
from proxnav.trials.scene_changes import without_target

Answer = tuple[SceneSpec, PoseResult]
_EMPTY = "no target"


def measure_conditions(
    mission: Mission, model: str, frames: int, empty: int, seed: int, backend: Backend = "auto", workers: int = 1,
    on: str = POOL, progress: Progress = silent,
) -> dict[str, Any]:  # fmt: skip
    """One row of numbers for each condition, over `frames` frames, and how many of `empty` frames gave a pose."""
    if frames < 1 or empty < 0:
        raise InputError(f"the benchmark needs 1 frame or more, found {frames}")
    job = _job(model, mission.target, backend, workers, on)
    sets = drawn_sets(mission, frames, empty, seed)
    scenes = [scene for some in sets.values() for scene in some]
    found: dict[int, PoseResult] = {}  # by `id`: scenes of several conditions share their index
    with progress("conditions", len(scenes)) as done:
        for scene, (_, result) in run_anywhere(job, scenes, workers, on, lambda scene: scene.filename):
            found[id(scene)] = result
            done()
    answers = {name: [(scene, found[id(scene)]) for scene in some] for name, some in sets.items()}
    accepted = sum(result.T_cam_target is not None for _, result in answers.pop(_EMPTY))
    return {"model": model, "rows": _rows(answers), "empty_frames": empty, "empty_frames_with_a_pose": accepted}


def drawn_sets(mission: Mission, frames: int, empty: int, seed: int) -> dict[str, list[SceneSpec]]:
    """Scenes by condition, and those without a target; every condition has the same views where it can."""

    accept = accepted_views(mission, mission.camera)

    def draw(count: int, drawn: RandomSceneConfig, change: Change) -> list[SceneSpec]:
        make = lambda k: random_scene(k, seed, drawn, mission.target, mission.camera, accept=accept)  # noqa: E731
        return [change(make(k)) for k in range(count)]

    sets = {name: draw(frames, drawn, change) for name, (drawn, change) in conditions(mission.scenes).items()}
    return sets | {_EMPTY: draw(empty, mission.scenes, without_target)}


def _job(model: str, target: str, backend: Backend, workers: int, on: str) -> SceneEstimateJob:
    threads = 0 if workers == 1 and on == POOL else 1
    return SceneEstimateJob(carried_model(model, on), load_target(target), backend, threads)


def _rows(answers: dict[str, list[Answer]]) -> dict[str, Any]:
    """A row for each condition; the nominal one is followed by its parts."""
    rows: dict[str, Any] = {}
    for name, some in answers.items():
        rows[name] = row(some)
        if name == "nominal":
            rows |= {part: row(inside) for part, inside in _parts(some).items()}
    return rows


def _parts(answers: Sequence[Answer]) -> dict[str, list[Answer]]:
    """The nominal frames by phase angle, and by what is behind the target."""
    phase = np.degrees([scene.phase_rad for scene, _ in answers])
    earth = np.array([is_before_earth(scene) for scene, _ in answers])
    groups = {f"  phase {a}-{b} deg": (phase >= a) & (phase < b) for a, b in ((0, 30), (30, 60), (60, 90))}
    groups |= {"  Earth behind": earth, "  black sky behind": ~earth}
    return {
        name: [answer for answer, inside in zip(answers, group, strict=True) if inside]
        for name, group in groups.items()
    }


def row(answers: Sequence[Answer]) -> dict[str, Any]:
    """Means and medians over the frames with a pose, and how many those are."""
    e_c, e_r, nees = [], [], []
    for scene, result in answers:
        if result.T_cam_target is None or result.covariance is None:
            continue
        errors = pose_errors(result.T_cam_target, scene.T_cam_target)
        e_c.append(errors.e_c)
        e_r.append(np.degrees(errors.e_r_rad))
        nees.append(float(squared_mahalanobis(difference(result.T_cam_target, scene.T_cam_target), result.covariance)))
    if not e_c:
        return {"frames": len(answers), "poses": 0}
    return {
        "frames": len(answers),
        "poses": len(e_c),
        "mean_e_c": float(np.mean(e_c)),
        "median_e_c": float(np.median(e_c)),
        "median_e_r_deg": float(np.median(e_r)),
        "p95_e_r_deg": float(np.percentile(e_r, 95)),
        "median_nees": float(np.median(nees)),
    }


def table(found: dict[str, Any]) -> str:
    """The rows as text."""
    lines = [f"{'':30s} {'poses':>9s} {'mean E_C':>9s} {'median':>8s} {'E_R med':>9s} {'95 %':>8s}"]
    for name, r in found["rows"].items():
        share = f"{r['poses']}/{r['frames']}"
        numbers = "        -"
        if r["poses"]:
            numbers = f"{r['mean_e_c']:9.4f} {r['median_e_c']:8.4f}"
            numbers += f" {r['median_e_r_deg']:5.2f} deg {r['p95_e_r_deg']:4.1f} deg"
        lines.append(f"{name:30s} {share:>9s} {numbers}")
    lines.append(f"no target: {found['empty_frames_with_a_pose']} of {found['empty_frames']} frames gave a pose")
    return "\n".join(lines)
