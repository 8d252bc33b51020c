"""Stars in the picture: points of light laid over four pixels, where Earth and its air leave them free."""

import numpy as np
from jaxtyping import Bool, Float, Float32

from proxnav.geometry import Camera
from proxnav.records import SceneSpec, Window
from proxnav.rendering.earth.ellipsoid import A_M
from proxnav.rendering.earth.stars import stars

_AIR_M = 60e3  # m, height below which a ray past Earth shows no star


def add_stars(image: Float32[np.ndarray, "h w band=3"], scene: SceneSpec, camera: Camera, window: Window) -> None:
    """Adds to `image`, in place, the radiance [W/(m^2 sr)] by which each star gives its irradiance.

    A star's light is shared bilinearly by the pixels about it, so that their sum is right and a window agrees with the
    whole image to the bit.
    """
    directions, irradiance = stars(scene)
    free = _free(scene, directions)
    rays = directions[free] @ scene.T_cam_target.R.T
    ahead = rays[:, 2] > 1e-3
    rays, light = rays[ahead], irradiance[free][ahead]
    pixels = camera.project(rays)
    per_pixel = camera.fx * camera.fy / rays[:, 2] ** 3  # 1 / solid angle of a pixel off the axis
    for place, power in zip(pixels, light * per_pixel[:, None], strict=True):
        if np.isfinite(place).all() and camera.contains(place):
            _splat(image, place - 0.5 - (window.x, window.y), power)


def _free(scene: SceneSpec, directions: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, "n"]:
    """Which directions do not meet Earth or its air from the camera."""
    if scene.earth is None:
        return np.ones(len(directions), bool)
    to_earth = np.array(scene.earth.r_target_earth_m) - scene.T_cam_target.inverse().t_m
    along = directions @ to_earth
    miss2 = to_earth @ to_earth - along**2
    return (along < 0.0) | (miss2 > (A_M + _AIR_M) ** 2)


def _splat(
    image: Float32[np.ndarray, "h w band=3"], place: Float[np.ndarray, "2"], power: Float[np.ndarray, "band=3"]
) -> None:
    """Shares `power` by the four pixels about `place` (column, row, in pixel centres)."""
    column, row = (int(value) for value in np.floor(place))
    fx, fy = place[0] - column, place[1] - row
    for i, wy in ((row, 1.0 - fy), (row + 1, fy)):
        for j, wx in ((column, 1.0 - fx), (column + 1, fx)):
            if 0 <= i < image.shape[0] and 0 <= j < image.shape[1]:
                image[i, j] += (wx * wy * power).astype(np.float32)
