"""From a SceneSpec to the radiance behind the target: along rays, through a camera, and all around the target."""

import math
from functools import cache, lru_cache

import numpy as np
from jaxtyping import Bool, Float, Float32

from proxnav.geometry import Camera, quaternion
from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.geometry.types import Rotation3x3, Vector3
from proxnav.records import SceneSpec, Window
from proxnav.rendering.earth import atmosphere, moon, sun
from proxnav.rendering.earth.aerial import Aerial, empty
from proxnav.rendering.earth.clouds import clouds
from proxnav.rendering.earth.ellipsoid import stretched
from proxnav.rendering.earth.image import block_px, draw, lattice_rays, lattice_size, room, shade_many
from proxnav.rendering.earth.imagery import ground_pyramid
from proxnav.rendering.earth.star_image import add_stars
from proxnav.rendering.earth.state import SIZE, Eye, World


@lru_cache(maxsize=64)
def _world(cover: float, seed: int, image: str) -> World:
    air = atmosphere.air()
    return World(air.transmittance, air.multiple, air.sky_irradiance, ground_pyramid(), clouds(cover, seed, image))


def _eye(scene: SceneSpec, r_target_eye_m: Vector3, show_sun: bool) -> tuple[Eye, Aerial, Rotation3x3]:
    """Eye, empty tables and R_ecef_target for a point given in target axes."""
    earth = scene.earth
    assert earth is not None
    R_ecef_target = quaternion.to_matrix(np.array(earth.q_target_ecef)).T
    origin = stretched(R_ecef_target @ (r_target_eye_m - np.array(earth.r_target_earth_m)))
    to_sun = R_ecef_target @ np.array(scene.sun.direction_target)
    to_sun /= np.linalg.norm(to_sun)
    to_sun_stretched = stretched(to_sun) / np.linalg.norm(stretched(to_sun))
    radius = float(np.linalg.norm(origin))
    to_moon, moon_half_angle = moon.seen_from(scene, r_target_eye_m - np.array(earth.r_target_earth_m))
    eye = Eye(
        origin,
        to_sun,
        to_sun_stretched,
        np.array(scene.sun.irradiance, dtype=np.float64),
        R_ecef_target @ to_moon,
        moon_half_angle,
        show_sun,
        earth.atmosphere,
        earth.city_lights,
    )
    return eye, empty(radius, float(origin @ to_sun_stretched) / radius), R_ecef_target


def _radiance(
    scene: SceneSpec, r_target_eye_m: Vector3, directions: Float[np.ndarray, "n 3"], pixel_rad: float, show_sun: bool
) -> Float32[np.ndarray, "n band=3"]:
    out = np.zeros((len(directions), 3), dtype=np.float32)
    if scene.earth is None:
        return _empty_space(scene, directions) if show_sun else out
    eye, aerial, R_ecef_target = _eye(scene, r_target_eye_m, show_sun)
    world = _world(scene.earth.cloud_cover, scene.earth.cloud_seed, scene.earth.cloud_image)
    shade_many(eye, world, aerial, room(), directions @ R_ecef_target.T, pixel_rad, out)
    return out


def _empty_space(scene: SceneSpec, directions: Float[np.ndarray, "n 3"]) -> Float32[np.ndarray, "n band=3"]:
    """Radiance without Earth: the Sun's disc, dimmed as the scene says."""
    out = np.zeros((len(directions), 3), dtype=np.float32)
    nu = directions @ np.array(scene.sun.direction_target)
    for i in np.flatnonzero(nu > math.cos(1.1 * SUN_HALF_ANGLE)):
        out[i] = [sun.disc(nu[i], k) * scene.sun.irradiance[k] * scene.sun.visible_fraction for k in range(3)]
    return out


def _camera_position(scene: SceneSpec) -> Vector3:
    return scene.T_cam_target.inverse().t_m


def background_radiance(
    scene: SceneSpec, directions_target: Float[np.ndarray, "n 3"], pixel_rad: float = 7e-4
) -> Float[np.ndarray, "n 3"]:
    """Radiance [W/(m^2 sr)] that reaches the camera along unit directions in target axes past the target.

    `pixel_rad` is the angle that one ray stands for: finer detail fades out. Stars are points: see `stars`.
    """
    directions = np.ascontiguousarray(directions_target, dtype=np.float64)
    return _radiance(scene, _camera_position(scene), directions, pixel_rad, show_sun=True)


def background_image(
    scene: SceneSpec,
    camera: Camera,
    window: Window,
    supersample: int = 1,
    hidden: Bool[np.ndarray, "h w"] | None = None,
) -> Float[np.ndarray, "h w 3"]:
    """Mean radiance [W/(m^2 sr)] of each pixel of a window of the (distorted) camera, without the target.

    Pixels that are `hidden` need not be drawn; what stands there means nothing.
    """
    n = supersample
    if n > 1:
        fine = Window(window.x * n, window.y * n, window.width * n, window.height * n)
        image = background_image(scene, camera.resized(camera.width * n, camera.height * n), fine)
        return image.reshape(window.height, n, window.width, n, 3).mean(axis=(1, 3), dtype=np.float32)
    hidden = np.zeros((window.height, window.width), bool) if hidden is None else hidden
    out = _empty_image(scene, camera, window) if scene.earth is None else _earth_image(scene, camera, window, hidden)
    add_stars(out, scene, camera, window)
    return out


def _earth_image(
    scene: SceneSpec, camera: Camera, window: Window, hidden: Bool[np.ndarray, "h w"]
) -> Float32[np.ndarray, "h w band=3"]:
    assert scene.earth is not None
    eye, aerial, R_ecef_target = _eye(scene, _camera_position(scene), show_sun=True)
    R_ecef_cam = R_ecef_target @ scene.T_cam_target.R.T
    world = _world(scene.earth.cloud_cover, scene.earth.cloud_seed, scene.earth.cloud_image)
    out = np.zeros((window.height, window.width, 3), dtype=np.float32)
    rays = lattice_rays(camera)
    block = block_px(camera)
    shape = lattice_size(block, window.x, window.y, window.width, window.height)
    states, ends = np.empty((*shape, SIZE), dtype=np.float32), np.empty(shape, dtype=np.int64)
    place = block, window.x, window.y, 1.0 / camera.fx
    draw(eye, world, aerial, room(), states, ends, rays, R_ecef_cam, *place, hidden, out)
    return out


def _empty_image(scene: SceneSpec, camera: Camera, window: Window) -> Float32[np.ndarray, "h w band=3"]:
    out = np.zeros((window.height, window.width, 3), dtype=np.float32)
    sun_cam = scene.T_cam_target.R @ np.array(scene.sun.direction_target)
    if sun_cam[2] <= 0.0:
        return out
    reach = 2.0 * SUN_HALF_ANGLE * max(camera.fx, camera.fy) / sun_cam[2] ** 2 + 2.0
    centre = camera.project(sun_cam)
    low = np.maximum(np.floor(centre - reach), (window.x, window.y))
    high = np.minimum(np.ceil(centre + reach), (window.x + window.width, window.y + window.height))
    if not (low < high).all():
        return out
    (x0, y0), (x1, y1) = low.astype(int), high.astype(int)
    pixels = np.stack(np.meshgrid(np.arange(x0, x1) + 0.5, np.arange(y0, y1) + 0.5), axis=-1)
    rays = camera.unproject(pixels).reshape(-1, 3)
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    part = _empty_space(scene, rays @ scene.T_cam_target.R).reshape(y1 - y0, x1 - x0, 3)
    out[y0 - window.y : y1 - window.y, x0 - window.x : x1 - window.x] = part
    return out


def environment_map(scene: SceneSpec, rows: int = 32) -> Float[np.ndarray, "rows cols 3"]:
    """Radiance [W/(m^2 sr)] around the target without the Sun's disc, equirectangular in target axes.

    Row 0 is at the +z pole; column j has azimuth atan2(y, x) = -pi + 2 pi (j + 0.5) / (2 rows).
    """
    directions = equirectangular(rows)
    flat = _radiance(scene, np.zeros(3), directions.reshape(-1, 3), math.pi / rows, show_sun=False)
    return flat.reshape(rows, 2 * rows, 3)


@cache
def equirectangular(rows: int) -> Float[np.ndarray, "rows columns 3"]:
    """Unit directions of the texels of an environment map, twice as many columns as rows."""
    polar = np.pi * (np.arange(rows) + 0.5) / rows
    azimuth = -np.pi + 2.0 * np.pi * (np.arange(2 * rows) + 0.5) / (2 * rows)
    theta, phi = np.meshgrid(polar, azimuth, indexing="ij")
    directions = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    directions.setflags(write=False)
    return directions
