"""Draws the pictures of docs/gallery.md in which Space Rider is seen; with --all Earth's and the sensor's too.

    python tools/gallery.py [--all] [NAME...]

Names: ranges, eclipse, flare, foil, pair. Tone mapping is for the eye only; the renderers give linear radiance.
"""

import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from earth_gallery import GALLERY
from earth_gallery import scene as over_earth
from proxnav.geometry import Camera
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import sun_visible_fraction
from proxnav.records import EarthSpec, RenderedFrame, SceneSpec
from proxnav.records.scene import SUN_IRRADIANCE
from proxnav.rendering.cycles import CyclesConfig
from proxnav.rendering.cycles.renderer import CyclesRenderer
from proxnav.rendering.raycast import RaycastConfig, RaycastRenderer
from proxnav.targets.loading import load_target
from sensor_effects import sun_picture, write

WHITE = float(np.mean(SUN_IRRADIANCE)) / np.pi
FINE = RaycastConfig(samples=16, interior_samples=8, sun_samples=32, bounces=3, ambient_rays=256, environment_rows=64)


def flying(view: SceneSpec, range_m: float, turn_deg: tuple[float, float, float], size: int) -> SceneSpec:
    """The view with Space Rider `range_m` in front of the camera, turned from the camera's axes by xyz angles."""
    R_cam_target = Rotation.from_euler("xyz", turn_deg, degrees=True).as_matrix()
    R_cam_ecef = view.T_cam_target.R
    R_target_ecef = R_cam_target.T @ R_cam_ecef
    assert view.earth is not None
    to_earth = R_target_ecef @ np.array(view.earth.r_target_earth_m) - R_cam_target.T @ [0.0, 0.0, range_m]
    q_target_ecef = Rotation.from_matrix(R_target_ecef).as_quat(scalar_first=True)
    sun = unit(R_target_ecef @ np.array(view.sun.direction_target))
    earth = EarthSpec(tuple(to_earth), tuple(q_target_ecef), view.earth.cloud_cover, view.earth.cloud_seed)
    return replace(
        view,
        target="space-rider",
        camera=Camera(size, size, 1.374 * size, 1.374 * size, size / 2, size / 2),
        q_cam_target=tuple(Rotation.from_matrix(R_cam_target).as_quat(scalar_first=True)),
        t_cam_target_m=(0.0, 0.0, range_m),
        sun=replace(view.sun, direction_target=tuple(sun), visible_fraction=_sunlit(to_earth, sun)),
        earth=earth,
    )


def _sunlit(to_earth: np.ndarray, sun: np.ndarray) -> float:
    return float(sun_visible_fraction(-to_earth, sun))


def exposed(radiance: np.ndarray, white: float = WHITE) -> np.ndarray:
    """8-bit picture in which a sunlit white plate is nearly white."""
    return display_at(radiance, 0.8 / white)


def display_at(radiance: np.ndarray, gain: float) -> np.ndarray:
    """8-bit sRGB picture (BGR) of a linear image at a fixed exposure."""
    v = radiance * gain
    v = np.clip(v / np.sqrt(1.0 + 0.3 * v * v), 0.0, 1.0)
    return (np.where(v < 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)[..., ::-1] * 255 + 0.5).astype(np.uint8)


def ranges(cast: RaycastRenderer) -> np.ndarray:
    """The target at 100, 50, 20 and 10 m over a sea with cloud."""
    view = over_earth(-20, -140, 50, 40, 62, 200, 0.45, 3)
    scenes = [flying(view, r, (20.0, 130.0, 170.0), 512) for r in (100.0, 50.0, 20.0, 10.0)]
    tiles = [label(exposed(cast.render(s).radiance), f"{s.t_cam_target_m[2]:.0f} m") for s in scenes]
    return np.vstack([np.hstack(tiles[:2]), np.hstack(tiles[2:])])


def eclipse(cast: RaycastRenderer) -> np.ndarray:
    """Entry into Earth's shadow at a fixed exposure; the last panel has twilight alone and a longer one."""
    tiles = []
    for elevation in (-19.4, -19.72, -19.9, -20.2):
        scene = flying(over_earth(5, 60, elevation, 270, 80, 90, 0.5, 6), 14.0, (15.0, 120.0, 160.0), 512)
        share, gain = scene.sun.visible_fraction, 1.0 if scene.sun.visible_fraction > 0.0 else 300.0
        text = f"{100 * share:.0f} % of the Sun" + ("" if gain == 1.0 else f", exposure x {gain:.0f}")
        tiles.append(label(exposed(gain * cast.render(scene).radiance), text))
    return np.vstack([np.hstack(tiles[:2]), np.hstack(tiles[2:])])


def flare(cast: RaycastRenderer) -> np.ndarray:
    """The Sun above the limb and in the field, through the colour camera of the speed class."""
    view = over_earth(-15, -120, 1, 272, 74, 272, 0.45, 6)
    scene = flying(view, 25.0, (25.0, 60.0, 170.0), 768)
    ray = unit(scene.camera.unproject(np.array([0.24, 0.2]) * 768))
    scene = replace(scene, sun=replace(scene.sun, direction_target=tuple(scene.T_cam_target.R.T @ ray)))
    return sun_picture(cast.render(scene), scene)


def foil(cast: RaycastRenderer) -> np.ndarray:
    """Insulation of crumpled foil from near by."""
    view = over_earth(-20, -140, 50, 40, 62, 200, 0.45, 3)
    scene, size = flying(view, 10.0, (20.0, 130.0, 170.0), 768), 768
    camera = Camera(size, size, 4.12 * size, 4.12 * size, 1.19 * size, 0.35 * size)  # aimed at the service module
    return exposed(cast.render(replace(scene, camera=camera)).radiance)


def pair(cast: RaycastRenderer) -> np.ndarray:
    """One scene by Cycles at 256 samples, by ray casting, and their ratio from half (blue) to double (red)."""
    scene = flying(over_earth(-20, -140, 50, 40, 62, 200, 0.45, 3), 16.0, (20.0, 130.0, 170.0), 448)
    with CyclesRenderer(cast.target, CyclesConfig(samples=256)) as cycles:
        a, b = cycles.render(scene), cast.render(scene)
    names = ("Cycles, 256 samples", "ray casting", "ratio, half to double")
    pictures = (exposed(a.radiance), exposed(b.radiance), _ratio(b, a))
    return np.hstack([label(picture, name) for picture, name in zip(pictures, names, strict=True)])


def _ratio(a: RenderedFrame, b: RenderedFrame) -> np.ndarray:
    ratio = np.log2((a.radiance.mean(axis=2) + 1e-3) / (b.radiance.mean(axis=2) + 1e-3))
    scaled = (np.clip(ratio, -1.0, 1.0) * 127 + 128).astype(np.uint8)
    return cv2.applyColorMap(scaled, cv2.COLORMAP_TWILIGHT_SHIFTED)


def label(image: np.ndarray, text: str) -> np.ndarray:
    """The picture with a caption in its corner."""
    out = np.ascontiguousarray(image)
    write(out, text, (14, 32), 0.7)
    return out


PICTURES: dict[str, Callable[[RaycastRenderer], np.ndarray]] = {
    "ranges": ranges,
    "eclipse": eclipse,
    "flare": flare,
    "foil": foil,
    "pair": pair,
}


def main(arguments: list[str]) -> None:
    """Writes the pictures named, or all."""
    names = [name for name in arguments if name != "--all"] or list(PICTURES)
    cast = RaycastRenderer(load_target("space-rider"), FINE)
    GALLERY.mkdir(parents=True, exist_ok=True)
    for name in names:
        image, quality = PICTURES[name](cast), 90
        while len(jpeg := cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()) > 290_000:
            quality -= 5
        (GALLERY / f"rider-{name}.jpg").write_bytes(jpeg)
        print(f"rider-{name}.jpg {len(jpeg) / 1000:.0f} kB", flush=True)
    if "--all" in arguments:
        for script in ("earth_gallery.py", "sensor_effects.py"):
            subprocess.run([sys.executable, Path(__file__).with_name(script)], check=True)


if __name__ == "__main__":
    main(sys.argv[1:])
