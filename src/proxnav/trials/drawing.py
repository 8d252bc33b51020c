"""Trial scenes to pictures, ray-cast."""

from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np

from proxnav.geometry import Pose, quaternion
from proxnav.geometry.types import Image
from proxnav.records import RenderedFrame, SceneSpec
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.scenes.plain import quadruple, triple
from proxnav.sensor.expose import expose
from proxnav.targets import Target
from proxnav.trials.conditions import TrialScene
from proxnav.trials.other_shapes import modified_shapes
from proxnav.trials.textures import photograph_like

_APART = (1.2, 3.0)
"""Distance of a second craft across the line of sight over the radius of the target."""


def draw_trial(trial: TrialScene, target: Target, others: Mapping[str, Target]) -> Image:
    """What the camera reads; `others` are the other craft by the name that conditions have for them."""
    rng = np.random.default_rng([trial.scene.exposure.seed, trial.scene.index])
    if trial.shown == "texture":
        return photograph_like(trial.scene.camera, rng)
    return expose(_frame(trial, target, others, rng), trial.scene).image


def _frame(trial: TrialScene, target: Target, others: Mapping[str, Target], rng: np.random.Generator) -> RenderedFrame:
    scene = trial.scene
    if trial.shown == "modified target":
        return _renderer(_modified(target, trial.subject)).render(scene)
    if trial.shown == "other craft":
        other = others[trial.subject]
        return _renderer(other).render(in_its_place(scene, target, other))
    frame = _renderer(target).render(scene)
    if trial.shown == "target twice":
        return _in_front_of(frame, _renderer(target).render(second_craft(scene, target, rng)))
    return frame


def in_its_place(scene: SceneSpec, target: Target, other: Target) -> SceneSpec:
    """Another craft where the target would be, so far away that it looks as large."""
    T = scene.T_cam_target
    middle = 0.5 * (other.vertices_m.min(axis=0) + other.vertices_m.max(axis=0))
    t_m = T.t_m * (other.size_m / target.size_m) - T.R @ middle
    return replace(scene, target=other.name, t_cam_target_m=triple(t_m))


def second_craft(scene: SceneSpec, target: Target, rng: np.random.Generator) -> SceneSpec:
    """The same craft beside and behind the first one, as the camera sees it, in another attitude."""
    T, radius = scene.T_cam_target, target.radius_m
    around, across = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(*_APART) * radius
    away = np.array([across * np.cos(around), across * np.sin(around), rng.uniform(0.5, 2.0) * radius])
    turned = quaternion.multiply(T.q_wxyz, quaternion.random(rng, 1)[0])
    second = Pose.from_wxyz("cam", "target", turned, T.t_m + away)
    to_sun = second.R.T @ T.R @ np.array(scene.sun.direction_target)
    return replace(
        scene, q_cam_target=quadruple(turned), t_cam_target_m=triple(second.t_m), earth=None,
        sun=replace(scene.sun, direction_target=triple(to_sun)),
    )  # fmt: skip


def _in_front_of(near: RenderedFrame, far: RenderedFrame) -> RenderedFrame:
    """Both craft in one picture; where an edge of the near one crosses the far one their light is mixed."""
    cover = near.coverage[..., None]
    behind = far.coverage[..., None] > 0.0
    light = np.where(behind, cover * near.radiance + (1.0 - cover) * far.radiance, near.radiance)
    nearer = near.mask
    return RenderedFrame(
        near.window, light.astype(np.float32), np.where(nearer, near.depth_m, far.depth_m),
        np.where(nearer, near.part, far.part), np.maximum(near.coverage, far.coverage),
    )  # fmt: skip


@lru_cache(maxsize=8)
def _renderer(target: Target) -> RaycastRenderer:
    return RaycastRenderer(target, RaycastConfig())


@lru_cache(maxsize=8)
def _modified(target: Target, name: str) -> Target:
    return modified_shapes(target)[name]()
