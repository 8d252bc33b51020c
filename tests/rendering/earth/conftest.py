"""Scenes over a place on Earth, for the tests of the background."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from proxnav.geometry import Camera
from proxnav.records import EarthSpec, SceneSpec, SunSpec

F2 = 6.69437999014e-3  # first eccentricity squared, WGS-84
SUN_E = (163.45, 184.86, 181.72)


def local_axes(lat_deg: float, lon_deg: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """East, north and up in Earth-fixed axes."""
    lat, lon = np.radians([lat_deg, lon_deg])
    up = np.array([np.cos(lat) * np.cos(lon), np.cos(lat) * np.sin(lon), np.sin(lat)])
    east = np.array([-np.sin(lon), np.cos(lon), 0.0])
    return east, np.cross(up, east), up


def position(lat_deg: float, lon_deg: float, altitude_m: float) -> np.ndarray:
    """Geodetic to Earth-fixed coordinates [m]."""
    _, _, up = local_axes(lat_deg, lon_deg)
    n = 6378137.0 / np.sqrt(1.0 - F2 * up[2] ** 2)
    return (n + altitude_m) * up - np.array([0.0, 0.0, n * F2 * up[2]])


@pytest.fixture
def over() -> Callable[..., SceneSpec]:
    """Builds a scene over (lat, lon): target axes are Earth-fixed, the camera looks off nadir towards an azimuth."""

    def build(
        lat_deg: float,
        lon_deg: float,
        sun_elevation_deg: float = 60.0,
        sun_azimuth_deg: float = 90.0,
        off_nadir_deg: float = 0.0,
        view_azimuth_deg: float = 0.0,
        altitude_m: float = 400e3,
        cloud_cover: float = 0.0,
        cloud_seed: int = 0,
        atmosphere: bool = True,
        size: int = 128,
        fx: float = 176.0,
    ) -> SceneSpec:
        east, north, up = local_axes(lat_deg, lon_deg)

        def towards(elevation_deg: float, azimuth_deg: float) -> np.ndarray:
            el, az = np.radians([elevation_deg, azimuth_deg])
            return np.cos(el) * (np.sin(az) * east + np.cos(az) * north) + np.sin(el) * up

        z = towards(off_nadir_deg - 90.0, view_azimuth_deg)
        y = -towards(off_nadir_deg, view_azimuth_deg)
        R_target_cam = np.stack([np.cross(y, z), y, z], axis=-1)
        q_cam_target = Rotation.from_matrix(R_target_cam.T).as_quat(scalar_first=True)
        r_ecef = position(lat_deg, lon_deg, altitude_m)
        earth = EarthSpec(tuple(-r_ecef), (1.0, 0.0, 0.0, 0.0), cloud_cover, cloud_seed, atmosphere)
        sun = SunSpec(tuple(towards(sun_elevation_deg, sun_azimuth_deg)), 1.0, SUN_E)
        camera = Camera(size, size, fx, fx, size / 2.0, size / 2.0)
        # The camera stands at the target's origin, so that places and angles are exact.
        return SceneSpec(0, "none", camera, tuple(q_cam_target), (0.0, 0.0, 0.0), sun, earth)

    return build
