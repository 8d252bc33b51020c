"""Scenes in which the light, the camera or the view is worse, one thing at a time."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import EARTH_MEAN_RADIUS
from proxnav.records import SceneSpec
from proxnav.scenes.random_scene import RandomSceneConfig
from proxnav.trials.scene_changes import noisier, sun_in_lens

Change = Callable[[SceneSpec], SceneSpec]


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


def is_before_earth(scene: SceneSpec) -> bool:
    """Whether the line of sight through the target's origin ends on Earth."""
    if scene.earth is None:
        return False
    centre = np.array(scene.earth.r_target_earth_m)
    ahead = -unit(scene.T_cam_target.inverse().t_m)
    along = float(ahead @ centre)
    return along > 0.0 and float(centre @ centre) - along**2 < EARTH_MEAN_RADIUS**2
