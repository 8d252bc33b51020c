"""Scenes in which the light, the camera or the view is worse, one thing at a time."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import EARTH_MEAN_RADIUS, sun_visible_fraction
from proxnav.learning.crops import BEHIND_M
from proxnav.records import SceneSpec
from proxnav.scenes.random_scene import RandomSceneConfig

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


def is_before_earth(scene: SceneSpec) -> bool:
    """Whether the line of sight through the target's origin ends on Earth."""
    if scene.earth is None:
        return False
    centre = np.array(scene.earth.r_target_earth_m)
    ahead = -unit(scene.T_cam_target.inverse().t_m)
    along = float(ahead @ centre)
    return along > 0.0 and float(centre @ centre) - along**2 < EARTH_MEAN_RADIUS**2
