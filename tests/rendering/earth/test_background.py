"""Photometry and consistency of what lies behind the target."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.records.rendered_frame import Window
from proxnav.rendering.earth import background_image, background_radiance, environment_map
from proxnav.rendering.earth.background import equirectangular
from proxnav.rendering.earth.surface import fresnel_water, glint

OCEAN = (-15.0, -140.0)
SAHARA = (23.0, 10.0)
SUN = np.array([163.45, 184.86, 181.72])


def whole(scene):
    return background_image(scene, scene.camera, Window(0, 0, scene.camera.width, scene.camera.height))


def reflectance(image, sun_elevation_deg):
    """Radiance as the albedo of a Lambertian ground at the top of the air."""
    return np.pi * image.mean(axis=(0, 1)) / (SUN * np.sin(np.radians(sun_elevation_deg)))


def disc_albedo(scene):
    """Mean radiance of Earth's disc over that of a white Lambertian disc that faces the Sun."""
    c = scene.camera
    light = whole(scene).sum(axis=(0, 1), dtype=np.float64) / c.fx**2
    distance = np.linalg.norm(scene.earth.r_target_earth_m)
    solid_angle = np.pi * (6371e3 / distance) ** 2
    return np.pi * light / (solid_angle * SUN)


@pytest.mark.parametrize("place", [(10.0, 20.0), (0.0, -150.0)])
def test_earth_seen_full_has_a_mean_albedo_between_0_2_and_0_4(over, place):
    scene = over(*place, sun_elevation_deg=89.99, altitude_m=3e8, cloud_cover=0.55, cloud_seed=2, size=160, fx=3000.0)
    assert 0.2 < disc_albedo(scene).mean() < 0.4


def test_ocean_is_dark_and_blue_away_from_the_glint(over):
    red, green, blue = reflectance(whole(over(*OCEAN, sun_elevation_deg=35.0)), 35.0)
    assert red < green < blue
    assert 0.03 < (red + green + blue) / 3.0 < 0.11


def test_desert_is_bright_and_reddish(over):
    red, green, blue = reflectance(whole(over(*SAHARA)), 60.0)
    assert red > blue
    assert 0.2 < (red + green) / 2.0 < 0.45


def test_thick_cloud_reflects_between_0_6_and_0_85(over):
    scene = over(*OCEAN, sun_elevation_deg=60.0, cloud_cover=1.0)
    bright = np.percentile(whole(scene).mean(axis=-1), 90) * np.pi / (SUN.mean() * np.sin(np.radians(60.0)))
    assert 0.6 < bright < 0.88


def test_the_glint_is_where_still_water_would_mirror_the_sun(over):
    # Sun 30 deg from the zenith: seen from 400 km, the mirror image lies about 2 deg nearer than on a flat sea.
    scene = over(*OCEAN, sun_elevation_deg=60.0, sun_azimuth_deg=90.0, off_nadir_deg=29.0, view_azimuth_deg=90.0)
    image = whole(scene).mean(axis=-1)
    row, column = np.unravel_index(image.argmax(), image.shape)
    assert np.hypot(row - 64, column - 64) < 25  # px of 0.33 deg
    away = replace(scene, sun=over(*OCEAN, sun_elevation_deg=60.0, sun_azimuth_deg=270.0).sun)
    assert whole(scene)[..., 0].max() > 3.0 * whole(away)[..., 0].max()


def test_the_glint_spreads_and_fades_with_wind():
    centre = [glint(0.8, 0.8, 2.0 * 0.8**2 - 1.0, wind) for wind in (2.0, 5.0, 10.0)]
    aside = [glint(0.8, 0.8, np.cos(2.0 * np.arccos(0.8) + 0.5), wind) for wind in (2.0, 5.0, 10.0)]
    assert centre[0] > centre[1] > centre[2] > 0.0
    assert all(np.isfinite(aside))


def test_still_water_reflects_two_percent_at_normal_incidence():
    assert abs(fresnel_water(1.0) - ((1.34 - 1.0) / (1.34 + 1.0)) ** 2) < 1e-12


def test_without_air_and_cloud_the_ground_is_lambertian(over):
    high, low = (whole(over(*SAHARA, sun_elevation_deg=e, atmosphere=False)).mean() for e in (80.0, 40.0))
    assert abs(low / high / (np.sin(np.radians(40.0)) / np.sin(np.radians(80.0))) - 1.0) < 0.05


def test_the_limb_glows_blue_by_day_and_red_at_sunset(over):
    def limb(elevation, azimuth, degrees):
        scene = over(*OCEAN, sun_elevation_deg=elevation, sun_azimuth_deg=azimuth)
        nadir = np.array(scene.earth.r_target_earth_m) / np.linalg.norm(scene.earth.r_target_earth_m)
        side = scene.T_cam_target.R.T[:, 0]
        angle = np.radians(degrees)
        return background_radiance(scene, (np.cos(angle) * nadir + np.sin(angle) * side)[None])[0]

    day = limb(60.0, 90.0, 70.8)
    assert day[2] > 1.5 * day[0] > 0.0
    sunset = limb(-17.0, 90.0, 70.25)
    assert sunset[0] > 2.0 * sunset[2] > 0.0


def test_space_is_black_above_the_air(over):
    scene = over(*OCEAN, off_nadir_deg=110.0)
    assert np.mean(whole(scene).max(axis=-1) > 0.0) < 0.01  # but for stars


def test_a_window_shows_the_same_pixels_as_the_whole_image(over):
    scene = over(30.0, 31.5, off_nadir_deg=50.0, cloud_cover=0.5, cloud_seed=3)
    part = background_image(scene, scene.camera, Window(37, 21, 50, 41))
    assert np.array_equal(part, whole(scene)[21:62, 37:87])


def test_the_same_scene_gives_the_same_bytes(over):
    scene = over(30.0, 31.5, cloud_cover=0.5, cloud_seed=3)
    assert whole(scene).tobytes() == whole(scene).tobytes()


def test_seeds_change_the_weather(over):
    one, two = (whole(over(*OCEAN, cloud_cover=0.5, cloud_seed=seed)) for seed in (1, 2))
    assert np.abs(one - two).mean() > 1.0


def test_the_image_agrees_with_single_rays(over):
    scene = over(30.0, 31.5, off_nadir_deg=55.0, cloud_cover=0.4, cloud_seed=5, size=256, fx=352.0)
    c, n = scene.camera, 256
    pixels = np.stack(np.meshgrid(np.arange(n) + 0.5, np.arange(n) + 0.5), axis=-1)
    rays = c.unproject(pixels).reshape(-1, 3) @ scene.T_cam_target.R
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    exact = background_radiance(scene, rays, pixel_rad=1.0 / c.fx).reshape(n, n, 3)
    error = np.abs(whole(scene) - exact).mean(axis=-1)
    assert np.median(error) < 0.01 * exact.mean()
    assert error.mean() < 0.03 * exact.mean()


def test_the_environment_map_agrees_with_single_rays(over):
    scene = over(0.0, 100.0, cloud_cover=0.4)
    rows = 32
    around = environment_map(scene, rows)
    directions = equirectangular(rows).reshape(-1, 3)
    single = background_radiance(scene, directions, pixel_rad=np.pi / rows).reshape(rows, 2 * rows, 3)
    sun = np.linalg.norm(equirectangular(rows) - np.array(scene.sun.direction_target), axis=-1) < 0.01
    assert np.allclose(around[~sun], single[~sun], rtol=1e-6)
    assert around.shape == (32, 64, 3)


def test_environment_map_rows_and_columns_follow_the_stated_angles():
    directions = equirectangular(8)
    assert directions[0, :, 2].min() > 0.9
    assert np.allclose(np.arctan2(directions[3, 5, 1], directions[3, 5, 0]), -np.pi + 2.0 * np.pi * 5.5 / 16)


def test_no_earth_is_a_black_environment(over):
    assert environment_map(replace(over(*OCEAN), earth=None)).max() == 0.0
