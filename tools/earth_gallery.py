"""Draws docs/gallery/earth-*.jpg: what the background model shows from 400 km.

Run: python tools/earth_gallery.py [NAME...]
Tone mapping is for the eye only; the model itself gives linear radiance.
"""

import sys
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

from proxnav.geometry import Camera
from proxnav.geometry.celestial import geodetic_to_ecef
from proxnav.records import EarthSpec, SceneSpec, SunSpec, Window
from proxnav.rendering.earth import background_image

GALLERY = Path(__file__).resolve().parents[1] / "docs" / "gallery"

# latitude, longitude, Sun elevation and azimuth there, view off nadir and azimuth (all deg), cloud cover and seed
VIEWS = {
    "ocean": (-15, -140, 55, 40, 0, 0, 0.50, 0),
    "coast": (30, 31.5, 55, 160, 0, 0, 0.20, 2),
    "glint": (-20, -110, 40, 60, 50, 60, 0.35, 4),
    "limb": (38, 10, 40, 180, 66, 120, 0.50, 5),
    "sunset": (5, 60, -14, 270, 70, 272, 0.50, 6),
    "terminator": (10, 90, 3, 90, 55, 100, 0.50, 7),
    "deck": (-50, -100, 35, 30, 35, 300, 0.75, 8),
    "night": (45, 5, -40, 20, 58, 110, 0.20, 9),
    "sunrise": (0, 20, -19.5, 90, 70.2, 90, 0.50, 10),
}


def scene(
    lat: float, lon: float, sun_el: float, sun_az: float, off_nadir: float, azimuth: float, cover: float, seed: int
) -> SceneSpec:
    """The view of a 40 deg camera 400 km above a place; target axes are Earth-fixed axes."""
    la, lo = np.radians([lat, lon])
    up = np.array([np.cos(la) * np.cos(lo), np.cos(la) * np.sin(lo), np.sin(la)])
    east = np.array([-np.sin(lo), np.cos(lo), 0.0])
    north = np.cross(up, east)
    r = geodetic_to_ecef(la, lo, 400e3)

    def towards(elevation: float, bearing: float) -> np.ndarray:
        el, az = np.radians([elevation, bearing])
        return np.cos(el) * (np.sin(az) * east + np.cos(az) * north) + np.sin(el) * up

    z, y = towards(off_nadir - 90.0, azimuth), -towards(off_nadir, azimuth)
    R_target_cam = np.stack([np.cross(y, z), y, z], axis=-1)
    q_cam_target = Rotation.from_matrix(R_target_cam.T).as_quat(scalar_first=True)
    sun = SunSpec(tuple(towards(sun_el, sun_az)))
    earth = EarthSpec(tuple(-r), (1.0, 0.0, 0.0, 0.0), cover, seed)
    camera = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0)
    return SceneSpec(0, "none", camera, tuple(q_cam_target), (0.0, 0.0, 0.0), sun, earth)


def display(radiance: np.ndarray) -> np.ndarray:
    """8-bit sRGB picture of a linear image, exposed for its brightest fiftieth."""
    v = radiance * (0.85 / max(1e-12, np.percentile(radiance.max(axis=-1), 98)))
    v = np.clip(v / np.sqrt(1.0 + 0.15 * v * v), 0.0, 1.0)
    return (np.where(v < 0.0031308, 12.92 * v, 1.055 * v ** (1 / 2.4) - 0.055)[..., ::-1] * 255 + 0.5).astype(np.uint8)


def main() -> None:
    """Writes the pictures named on the command line, or all."""
    GALLERY.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[1:] or VIEWS:
        view = scene(*VIEWS[name])
        image = display(background_image(view, view.camera, Window(0, 0, 1024, 1024), supersample=2))
        quality = 90
        while len(jpeg := cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, quality])[1].tobytes()) > 290_000:
            quality -= 5
        (GALLERY / f"earth-{name}.jpg").write_bytes(jpeg)


if __name__ == "__main__":
    main()
