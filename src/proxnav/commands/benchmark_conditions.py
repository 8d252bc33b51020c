"""`proxnav benchmark conditions`: the same model where the light, the camera or the view get worse, one at a time."""

import json
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from proxnav.cli.progress import progress
from proxnav.cluster.jobs import POOL, check_workers, run_anywhere
from proxnav.commands.estimate_jobs import carried_model
from proxnav.commands.look_jobs import LookJob
from proxnav.detection.sessions import Backend
from proxnav.errors import InputError
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import EARTH_MEAN_RADIUS, sun_visible_fraction
from proxnav.geometry.mahalanobis import squared_mahalanobis
from proxnav.geometry.perturbation import difference
from proxnav.geometry.pose_errors import pose_errors
from proxnav.learning.crops import BEHIND_M
from proxnav.missions import Mission, load_mission
from proxnav.records import PoseResult, SceneSpec
from proxnav.scenes.random_scene import RandomSceneConfig, random_scene
from proxnav.storage.files import write_json
from proxnav.targets.loading import load_target

Change = Callable[[SceneSpec], SceneSpec]


@dataclass(frozen=True)
class ConditionsConfig:
    """Ray-cast frames of the mission under each condition; every condition sees the same views where it can."""

    model: str = "space-rider"
    """Name or folder."""
    frames: int = 40
    """Under each condition."""
    empty: int = 200
    """Frames without a target."""
    seed: int = 500
    preset: str = "observation-10-100m"
    backend: Backend = "auto"
    workers: int = 1
    """Processes; on a Ray cluster, 0 takes every processor."""
    on: str = POOL
    """pool (processes of this machine), ray, or ray://host:port."""
    dry_run: bool = False
    """Only say what time and disk it would take, tried on a little of it."""
    json: bool = False
    """Print JSON instead of a table."""
    out: Path | None = None
    """Folder for conditions.json."""


def run(config: ConditionsConfig) -> None:
    """Entry of `proxnav benchmark conditions`."""
    if config.frames < 1 or config.empty < 0:
        raise InputError(f"the benchmark needs 1 frame or more, found {config.frames}")
    check_workers(config.workers, config.on)
    if config.dry_run:
        print(dry_run(config))
        return
    found = measure(config)
    if config.out is not None:
        write_json(config.out / "conditions.json", found, indent=1)
    print(json.dumps(found, indent=1) if config.json else table(found))


def conditions(scenes: RandomSceneConfig) -> dict[str, tuple[RandomSceneConfig, Change]]:
    """Name -> (how scenes are drawn, what is changed in each)."""
    near = replace(scenes, view=replace(scenes.view, range_m=(10.0, 10.0), partial_share=1.0))
    textures = replace(scenes, texture_strength=(1.0, 1.0))
    backlit = replace(scenes, sun=replace(scenes.sun, max_phase_rad=np.radians(150.0)))
    penumbra = replace(scenes, sun=replace(scenes.sun, penumbra_share=1.0))
    return {
        "nominal": (scenes, lambda scene: scene),
        "noise x2": (scenes, lambda scene: noisier(scene, 2.0)),
        "noise x4": (scenes, lambda scene: noisier(scene, 4.0)),
        "motion blur 2 px": (scenes, lambda scene: blurred(scene, 2.0)),
        "motion blur 5 px": (scenes, lambda scene: blurred(scene, 5.0)),
        "particle storm, 1000 /cm2/s": (scenes, storm),
        "textures fully random": (textures, lambda scene: scene),
        "phase angle up to 150 deg": (backlit, lambda scene: scene),
        "penumbra": (penumbra, lambda scene: scene),
        "Sun 35 deg off the axis": (scenes, lambda scene: sun_in_lens(scene, np.radians(35.0))),
        "Sun in the picture, 15 deg": (scenes, lambda scene: sun_in_lens(scene, np.radians(15.0))),
        "cut by the frame at 10 m": (near, lambda scene: scene),
    }


def noisier(scene: SceneSpec, factor: float) -> SceneSpec:
    """A sensor whose noise is `factor` times as large against the signal: fewer electrons, more of everything else."""
    s = scene.sensor
    few = 1.0 / factor**2
    sensor = replace(
        s,
        full_well_e=s.full_well_e * few,
        gain_e_per_dn=s.gain_e_per_dn * few,
        read_noise_e=s.read_noise_e * few * factor,
        dsnu_e=s.dsnu_e * few * factor,
        dark_current_e_per_s=s.dark_current_e_per_s * few,
        prnu=s.prnu * factor,
    )
    return replace(scene, sensor=sensor)


def blurred(scene: SceneSpec, pixels: float) -> SceneSpec:
    """The camera turns by that many pixels during an exposure of 10 ms."""
    exposure_s = 10e-3
    rate = pixels / scene.camera.fx / exposure_s
    x, _, z = scene.t_cam_target_m
    moves = (-rate * z, 0.0, rate * x)  # -omega x t: the target as the turning camera sees it
    exposure = replace(scene.exposure, exposure_s=exposure_s, omega_cam_radps=(0.0, rate, 0.0), v_cam_target_mps=moves)
    dimmer = replace(scene.sensor, transmission=scene.sensor.transmission * 0.18e-3 / exposure_s)
    return replace(scene, exposure=exposure, sensor=dimmer)


def storm(scene: SceneSpec) -> SceneSpec:
    """The South Atlantic Anomaly at its worst."""
    return replace(scene, sensor=replace(scene.sensor, particle_rate_cm2_s=1000.0))


def sun_in_lens(scene: SceneSpec, off_axis_rad: float) -> SceneSpec:
    """The Sun that far from the camera's axis, on the side where Earth hides it least: flare, and a target in shade."""
    R_target_cam = scene.T_cam_target.R.T
    around = np.radians(np.arange(0, 360, 30) + scene.index)
    across = np.sin(off_axis_rad) * np.array([np.cos(around), np.sin(around)])
    in_camera = np.vstack([across, np.full_like(around, np.cos(off_axis_rad))])
    directions = (R_target_cam @ in_camera).T
    if scene.earth is None:
        fractions = np.ones(len(directions))
    else:
        r_target = -np.array(scene.earth.r_target_earth_m)
        fractions = np.array([sun_visible_fraction(r_target, direction) for direction in directions])
    best = int(np.argmax(fractions))
    x, y, z = directions[best]
    sun = replace(scene.sun, direction_target=(float(x), float(y), float(z)), visible_fraction=float(fractions[best]))
    return replace(scene, sun=sun)


def without_target(scene: SceneSpec) -> SceneSpec:
    """What a camera sees that points elsewhere: sky, limb or Earth; one in four is noisy, one in four has the Sun."""
    empty = replace(scene, t_cam_target_m=BEHIND_M)
    kind = scene.index % 4
    if kind == 2:
        return noisier(empty, 4.0)
    return sun_in_lens(empty, np.radians(15.0)) if kind == 3 else empty


def measure(config: ConditionsConfig) -> dict[str, Any]:
    """One row of numbers for each condition, and what frames without a target gave."""
    mission = load_mission(config.preset)
    sets = {
        name: [change(_scene(i, config, mission, drawn)) for i in range(config.frames)]
        for name, (drawn, change) in conditions(mission.scenes).items()
    }
    empty = [without_target(_scene(i, config, mission, mission.scenes)) for i in range(config.empty)]
    seen = _seen([scene for scenes in (*sets.values(), empty) for scene in scenes], mission, config)
    rows: dict[str, Any] = {}
    for name, scenes in sets.items():
        results = [seen[id(scene)] for scene in scenes]
        rows[name] = row(scenes, results)
        if name == "nominal":
            rows |= _split(scenes, results)
    accepted = sum(seen[id(scene)].T_cam_target is not None for scene in empty)
    return {"model": config.model, "rows": rows, "empty_frames": config.empty, "empty_frames_with_a_pose": accepted}


def _scene(index: int, config: ConditionsConfig, mission: Mission, drawn: RandomSceneConfig) -> SceneSpec:
    return random_scene(index, config.seed, drawn, mission.target, mission.camera)


def _seen(scenes: Sequence[SceneSpec], mission: Mission, config: ConditionsConfig) -> dict[int, PoseResult]:
    """By `id` of the scene: scenes of several conditions share their index."""
    found: dict[int, PoseResult] = {}
    with progress("conditions", len(scenes)) as done:
        for scene, (_, result) in run_anywhere(_job(mission, config), scenes, config.workers, config.on, _named):
            found[id(scene)] = result
            done()
    return found


def _job(mission: Mission, config: ConditionsConfig) -> LookJob:
    alone = config.workers == 1 and config.on == POOL
    model = carried_model(config.model, config.on)
    return LookJob(model, load_target(mission.target), config.backend, 0 if alone else 1)


def _named(scene: SceneSpec) -> str:
    return scene.filename


def dry_run(config: ConditionsConfig) -> str:
    """Measured on four nominal frames."""
    from proxnav.commands.dry_run import Estimate, seconds_each

    mission = load_mission(config.preset)
    scenes = [_scene(i, config, mission, mission.scenes) for i in range(4)]
    frames = len(conditions(mission.scenes)) * config.frames + config.empty
    lanes = max(1, min(config.workers, os.cpu_count() or 1))
    return Estimate(seconds_each(_job(mission, config)(), scenes) * frames / lanes, 5e3).text(f"{frames} frames")


def _split(scenes: Sequence[SceneSpec], results: Sequence[PoseResult]) -> dict[str, Any]:
    """The nominal frames by phase angle, and by what is behind the target."""
    phase = np.degrees([scene.phase_rad for scene in scenes])
    earth = np.array([is_before_earth(scene) for scene in scenes])
    groups = {f"  phase {a}-{b} deg": (phase >= a) & (phase < b) for a, b in ((0, 30), (30, 60), (60, 90))}
    groups |= {"  Earth behind": earth, "  black sky behind": ~earth}
    pairs = list(zip(scenes, results, strict=True))
    chosen = {
        name: [pair for pair, inside in zip(pairs, group, strict=True) if inside] for name, group in groups.items()
    }
    return {name: row([scene for scene, _ in some], [result for _, result in some]) for name, some in chosen.items()}


def is_before_earth(scene: SceneSpec) -> bool:
    """Whether the line of sight through the target's origin ends on Earth."""
    if scene.earth is None:
        return False
    centre = np.array(scene.earth.r_target_earth_m)
    ahead = -unit(scene.T_cam_target.inverse().t_m)
    along = float(ahead @ centre)
    return along > 0.0 and float(centre @ centre) - along**2 < EARTH_MEAN_RADIUS**2


def row(scenes: Sequence[SceneSpec], results: Sequence[PoseResult]) -> dict[str, Any]:
    """Means and medians over the frames with a pose, and how many those are."""
    e_c, e_r, nees = [], [], []
    for scene, result in zip(scenes, results, strict=True):
        if result.T_cam_target is None or result.covariance is None:
            continue
        errors = pose_errors(result.T_cam_target, scene.T_cam_target)
        d = difference(result.T_cam_target, scene.T_cam_target)
        e_c.append(errors.e_c)
        e_r.append(np.degrees(errors.e_r_rad))
        nees.append(float(squared_mahalanobis(d, result.covariance)))
    if not e_c:
        return {"frames": len(scenes), "poses": 0}
    return {
        "frames": len(scenes),
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
        if r["poses"]:
            numbers = f"{r['mean_e_c']:9.4f} {r['median_e_c']:8.4f}"
            numbers += f" {r['median_e_r_deg']:5.2f} deg {r['p95_e_r_deg']:4.1f} deg"
        else:
            numbers = "        -"
        lines.append(f"{name:30s} {share:>9s} {numbers}")
    lines.append(f"no target: {found['empty_frames_with_a_pose']} of {found['empty_frames']} frames gave a pose")
    return "\n".join(lines)
