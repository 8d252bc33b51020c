"""What makes a scene harder: noise, a Sun in the lens, an empty sky."""

from dataclasses import replace

import numpy as np

from proxnav.geometry.celestial import sun_visible_fraction
from proxnav.records import ExposureSpec, SceneSpec
from proxnav.scenes.plain import BEHIND_M


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


def stars_only(scene: SceneSpec) -> SceneSpec:
    """Stars that are exposed long, sharp to out of focus by 4 px, with no Earth and no target."""
    sensor = replace(scene.sensor, psf_sigma_px=(0.7, 1.5, 2.5, 4.0)[scene.index % 4])
    exposure = ExposureSpec(exposure_s=(0.05, 0.2, 0.8)[scene.index % 3], seed=scene.exposure.seed)
    return replace(scene, t_cam_target_m=BEHIND_M, earth=None, sensor=sensor, exposure=exposure)


def striped(scene: SceneSpec) -> SceneSpec:
    """A sensor whose rows have offsets of 4 to 10 DN of 255."""
    full = (2**scene.sensor.bits - 1) / 255.0
    return replace(scene, sensor=replace(scene.sensor, row_noise_dn=(4.0 + scene.index % 4 * 2.0) * full))


def over_exposed(scene: SceneSpec, factor: float) -> SceneSpec:
    """A sensor that exposes `factor` times as long as it should."""
    return replace(scene, sensor=replace(scene.sensor, exposure_bias=scene.sensor.exposure_bias * factor))
