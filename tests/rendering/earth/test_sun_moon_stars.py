"""Sun's disc, Moon and stars as sources of the right size and strength."""

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from proxnav.geometry import Camera
from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.records import EarthSpec, SceneSpec, SunSpec
from proxnav.records.rendered_frame import Window
from proxnav.rendering.earth import background_image, background_radiance, moon, stars, sun

CAMERA = Camera(64, 64, 4000.0, 4000.0, 32.0, 32.0)
AHEAD = SunSpec((0.0, 0.0, 1.0))
EMPTY = SceneSpec(0, "none", CAMERA, (1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 10.0), AHEAD)


def irradiance(image: np.ndarray, camera: Camera) -> np.ndarray:
    """W/m^2 at normal incidence of a narrow image."""
    return image.sum(axis=(0, 1), dtype=np.float64) / (camera.fx * camera.fy)


def test_the_suns_disc_integrates_to_its_irradiance():
    image = background_image(EMPTY, CAMERA, Window(0, 0, 64, 64), supersample=4)
    assert np.allclose(irradiance(image, CAMERA), AHEAD.irradiance, rtol=0.01)


def test_the_sun_is_dimmed_in_eclipse_when_no_earth_hides_it():
    half = replace(EMPTY, sun=replace(AHEAD, visible_fraction=0.5))
    ray = np.array([[0.0, 0.0, 1.0]])
    assert np.allclose(background_radiance(half, ray), 0.5 * background_radiance(EMPTY, ray))


def test_the_suns_limb_is_darker_than_its_centre_most_of_all_in_blue():
    edge = np.cos(0.97 * SUN_HALF_ANGLE)
    ratios = [sun.disc(edge, band) / sun.disc(1.0, band) for band in range(3)]
    assert 1.0 > ratios[0] > ratios[1] > ratios[2] > 0.2


def test_the_sun_behind_earth_is_not_seen():
    earth = EarthSpec((0.0, 0.0, 6_778_137.0), (1.0, 0.0, 0.0, 0.0), 0.0, 0)
    image = background_image(replace(EMPTY, earth=earth), CAMERA, Window(0, 0, 64, 64))
    assert image.max() < 1e-3  # W/(m^2 sr), night side; the Sun would give 2e6


def test_the_moon_stands_where_the_ephemeris_says():
    # JPL DE405 by way of Meeus, Astronomical Algorithms, example 47.a: 1992 April 12, 0 h TD.
    ra, dec, distance_m = np.radians(134.688), np.radians(13.768), 368_409.7e3
    found = moon.position_eci_m("1992-04-12T00:00:00Z", 0.0)
    expected = np.array([np.cos(dec) * np.cos(ra), np.cos(dec) * np.sin(ra), np.sin(dec)])
    angle = np.degrees(np.arccos(found @ expected / np.linalg.norm(found)))
    assert angle < 0.5  # deg
    assert abs(np.linalg.norm(found) / distance_m - 1.0) < 0.01


def test_the_full_moon_is_four_hundred_thousand_times_fainter_than_the_sun():
    half_angle, band = 4.52e-3, 1
    angles = np.linspace(0.0, half_angle, 400)
    rays = [(np.sin(a), 0.0, np.cos(a)) for a in angles]
    face = [moon.disc(ray, (0.0, 0.0, 1.0), (0.0, 0.0, -1.0), half_angle, band) for ray in rays]
    ratio = np.trapezoid(face * np.sin(angles), angles) * 2.0 * np.pi
    assert 1.0 / 500_000 < ratio < 1.0 / 300_000


def test_stars_are_unit_vectors_and_sirius_is_the_brightest():
    directions, light = stars(EMPTY)
    assert np.allclose(np.linalg.norm(directions, axis=1), 1.0)
    assert light[:, 1].argmax() == 0
    assert 1.0e-8 < light[0, 1] < 2.0e-8  # W/m^2: 3.6e-9 times 10^(0.4 * 1.46)


def test_red_stars_are_red():
    from proxnav.rendering.earth.stars import BRIGHT

    names = list(BRIGHT)
    _, light = stars(EMPTY)
    ratio = dict(zip(names, light[:, 0] / light[:, 2], strict=True))
    assert ratio["Betelgeuse"] > 3.0 * ratio["Vega"] > ratio["Spica"]


def _aimed_at_sirius(scene):
    direction = stars(scene)[0][0]
    R = Rotation.align_vectors([[0.02, -0.03, 1.0]], [direction])[0]
    return replace(scene, q_cam_target=tuple(R.as_quat(scalar_first=True)), earth=None)


def test_a_star_in_the_picture_gives_its_irradiance(over):
    scene = _aimed_at_sirius(over(0.0, 0.0))
    camera = scene.camera
    image = background_image(scene, camera, Window(0, 0, camera.width, camera.height))
    column, row = (int(x) for x in camera.project(scene.T_cam_target.R @ stars(scene)[0][0]))
    flux = image[row - 2 : row + 3, column - 2 : column + 3].sum(axis=(0, 1)) / (camera.fx * camera.fy)
    assert np.allclose(flux, stars(scene)[1][0], rtol=0.01)
    part = background_image(scene, camera, Window(column, row - 20, 40, 40))
    assert np.array_equal(part, image[row - 20 : row + 20, column : column + 40])


def test_earth_hides_stars(over):
    scene = _aimed_at_sirius(over(0.0, 0.0))
    direction = stars(scene)[0][0]
    earth = over(0.0, 0.0).earth
    window = Window(0, 0, scene.camera.width, scene.camera.height)
    before = replace(earth, r_target_earth_m=tuple(6.8e6 * direction), atmosphere=False, city_lights=False)
    night = replace(scene, earth=before, sun=replace(scene.sun, direction_target=tuple(direction)))
    assert background_image(scene, scene.camera, window).max() > 1e-4
    assert background_image(night, scene.camera, window).max() < 1e-6
