"""Draws docs/gallery/sensor-effects.jpg: what each effect of the sensor does, alone, and the Sun in the lens.

    python tools/sensor_effects.py

Effects are shown several times stronger than in the presets, where they would hardly show at this size; the captions
say how strong. The last row is the speed-class sensor as it is.
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

import cv2
import numpy as np

from proxnav.geometry import Camera
from proxnav.geometry.arrays import unit
from proxnav.missions import load_mission
from proxnav.records import ExposureSpec, RenderedFrame, SceneSpec, SensorSpec
from proxnav.rendering.raycast import RaycastRenderer
from proxnav.scenes.random_scene import random_scene
from proxnav.sensor import choose_exposure, expose
from proxnav.sensor.auto_exposure import AutoExposure
from proxnav.sensor.colour import demosaic
from proxnav.sensor.photometry import electrons_per_radiance
from proxnav.sensor.presets import SENSORS
from proxnav.targets.loading import load_target

OUT = Path(__file__).parents[1] / "docs" / "gallery" / "sensor-effects.jpg"
TILE = 320  # px
CLEAN = SensorSpec(bits=8, full_well_e=32_500.0)


@dataclass(frozen=True)
class Panel:
    """One picture: a caption, the camera, how it is exposed, and by how much the image is enlarged."""

    caption: str
    sensor: SensorSpec
    exposure: ExposureSpec = field(default_factory=ExposureSpec)
    stops: float = 0.0
    zoom: int = 1


def panels() -> list[Panel]:
    """The effects one by one."""
    still = ExposureSpec()
    noisy_well = replace(CLEAN, full_well_e=400.0)
    bad_pixels = replace(CLEAN, hot_pixel_share=1e-3, dead_pixel_share=1e-3, dark_current_e_per_s=1e4)
    return [
        Panel("ideal sensor", CLEAN),
        Panel("cos^4 (40 deg lens)", replace(CLEAN, cos4=True)),
        Panel("PSF sigma 2 px", replace(CLEAN, psf_sigma_px=2.0)),
        Panel("focus at 0.2 m, f/1", replace(CLEAN, focus_m=0.2, f_number=1.0)),
        Panel("target moves 12 px", CLEAN, replace(still, v_cam_target_mps=(3.4, 1.7, 0.0), seed=1)),
        Panel("camera turns 12 px", CLEAN, replace(still, omega_cam_radps=(0.0, 0.3, 0.0), seed=1)),
        Panel("veiling glare 15 %", replace(CLEAN, veiling_glare=0.15)),
        Panel("halo 15 %, 1 stop over", replace(CLEAN, halo=0.15), stops=1.0),
        Panel("photon noise, well 400 e-", noisy_well),
        Panel("read noise 10 DN", replace(CLEAN, read_noise_e=1270.0, black_level_dn=20.0)),
        Panel("PRNU 10 %", replace(CLEAN, prnu=0.10)),
        Panel("row and column 5 DN", replace(CLEAN, row_noise_dn=5.0, column_noise_dn=5.0, black_level_dn=10.0)),
        Panel("hot, dead pixels 1e-3, 60 C", bad_pixels),
        Panel("particles, well 2000 e-", replace(CLEAN, full_well_e=2e3, particle_rate_cm2_s=3e4, readout_s=0.05)),
        Panel("blooming, 3 stops over", replace(CLEAN, blooming=0.9), stops=3.0),
        Panel("Bayer mosaic, x 6", replace(SENSORS["speed-class-colour"], black_level_dn=0.0), zoom=6),
    ]


def main() -> None:
    """Render the scenes, expose them panel by panel and write the sheet."""
    renderer = RaycastRenderer(load_target("space-rider"))
    scene = base_scene(BEFORE_EARTH)
    frame = renderer.render(scene)
    tiles = [tile(picture(frame, scene, panel), panel.caption, panel.zoom) for panel in panels()]
    for caption, sun_px in SUN_PLACES:
        sunny = with_sun(base_scene(BEFORE_SPACE), sun_px)
        tiles.append(tile(sun_picture(renderer.render(sunny), sunny), caption, 1))
    rows = [np.hstack(tiles[k : k + 4]) for k in range(0, len(tiles), 4)]
    OUT.parent.mkdir(parents=True, exist_ok=True)
    cv2.imwrite(str(OUT), np.vstack(rows), [cv2.IMWRITE_JPEG_QUALITY, 78])
    print(OUT, f"{OUT.stat().st_size / 1000:.0f} kB")


SUN_PLACES = (
    ("Sun in the field", (0.20, 0.17)),
    ("Sun near a corner", (0.93, 0.88)),
    ("Sun outside the field", (1.25, -0.1)),
    ("Sun behind the target", None),
)


def base_scene(index: int) -> SceneSpec:
    """One of the random scenes of the observation mission, from 14 m."""
    camera = load_mission("observation-10-100m").camera.resized(TILE, TILE)
    scene = random_scene(index, 3, load_mission("observation-10-100m").scenes, "space-rider", camera)
    return replace(scene, t_cam_target_m=(0.0, 0.0, 14.0))


BEFORE_EARTH, BEFORE_SPACE = 10, 8


def picture(frame: RenderedFrame, scene: SceneSpec, panel: Panel) -> np.ndarray:
    """(h, w, 3) BGR as the panel's camera reads the frame."""
    scene = replace(scene, sensor=panel.sensor, exposure=replace(panel.exposure, exposure_s=0.0))
    exposure_s = choose_exposure(frame, scene, AutoExposure(shortest_s=1e-9, longest_s=1.0)) * 2.0**panel.stops
    if panel.exposure.seed:  # motion is given for 0.1 s
        rates = panel.exposure
        slow = 0.1 / exposure_s
        rates = replace(
            rates,
            v_cam_target_mps=tuple(v * slow for v in rates.v_cam_target_mps),
            omega_cam_radps=tuple(v * slow for v in rates.omega_cam_radps),
        )
        scene = replace(scene, exposure=rates)
    if panel.sensor.hot_pixel_share:
        scene = replace(scene, exposure=ExposureSpec(temperature_c=60.0))
    return cv2.cvtColor(expose(frame, scene, exposure_s).image, cv2.COLOR_GRAY2BGR)


def with_sun(scene: SceneSpec, place: tuple[float, float] | None) -> SceneSpec:
    """The scene with the Sun imaged at a place (shares of width and height); None is behind the target's middle."""
    camera: Camera = scene.camera
    x, y = place or (0.5, 0.5)
    ray_cam = unit(camera.unproject(np.array([x * camera.width, y * camera.height])))
    direction = scene.T_cam_target.R.T @ ray_cam
    return replace(scene, sun=replace(scene.sun, direction_target=tuple(direction.tolist()), visible_fraction=1.0))


def sun_picture(frame: RenderedFrame, scene: SceneSpec) -> np.ndarray:
    """(h, w, 3) BGR by the colour camera of the speed class."""
    scene = replace(scene, sensor=SENSORS["speed-class-colour"])
    exposure_s = 0.18e-3
    rgb = demosaic(expose(frame, scene, exposure_s).image).astype(np.float64)
    white = electrons_per_radiance(scene.sensor) * scene.sun.irradiance
    balanced = (rgb - scene.sensor.black_level_dn) * white[1] / white  # sunlit white becomes white
    return np.clip(balanced, 0.0, 255.0).astype(np.uint8)[..., ::-1]


def tile(image: np.ndarray, caption: str, zoom: int) -> np.ndarray:
    """The image at the tile's size, its middle enlarged, with its caption."""
    half = TILE // 2 // zoom
    y, x = image.shape[0] // 2, image.shape[1] // 2
    crop = image[y - half : y + half, x - half : x + half]
    out = cv2.resize(crop, (TILE, TILE), interpolation=cv2.INTER_NEAREST if zoom > 1 else cv2.INTER_AREA).copy()
    write(out, caption, (8, 18), 0.48)
    return out


def write(image: np.ndarray, text: str, place: tuple[int, int], scale: float) -> None:
    """White text with a black rim; a thicker stroke would be wider letters, so the rim is the same text moved."""
    for dx, dy in [(x, y) for x in (-1, 0, 1) for y in (-1, 0, 1) if (x, y) != (0, 0)]:
        cv2.putText(image, text, (place[0] + dx, place[1] + dy), cv2.FONT_HERSHEY_SIMPLEX, scale, (0, 0, 0), 1)
    cv2.putText(image, text, place, cv2.FONT_HERSHEY_SIMPLEX, scale, (255, 255, 255), 1, cv2.LINE_AA)


if __name__ == "__main__":
    main()
