"""The Sun in the lens: where its light goes, how much, and when there is none."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.geometry import Camera
from proxnav.geometry.arrays import unit
from proxnav.geometry.celestial import SUN_HALF_ANGLE
from proxnav.records import ExposureSpec, SensorSpec, SunSpec, Window
from proxnav.sensor import expose, flare
from proxnav.sensor.expose import form_image

CAMERA = Camera(256, 192, 300.0, 300.0, 128.0, 96.0)
SENSOR = SensorSpec(bits=12, flare=True)
WINDOW = Window(0, 0, 256, 192)


def _sun_at(x: float, y: float, **more) -> SunSpec:
    ray = unit(CAMERA.unproject(np.array([x, y])))
    return SunSpec(direction_target=tuple(ray.tolist()), **more)


def _black(make_frame, coverage=None):
    return make_frame(np.zeros((192, 256)), coverage)


def _rate(make_frame, make_scene, sun, sensor=SENSOR, coverage=None):
    scene = make_scene(sensor, ExposureSpec(1e-4), sun)
    return form_image(_black(make_frame, coverage), scene, 1e-4, CAMERA)


def test_the_sun_is_imaged_where_it_stands(make_frame, make_scene):
    rate = _rate(make_frame, make_scene, _sun_at(190.25, 50.75))
    y, x = np.nonzero(rate > 0.3 * rate.max())
    assert x.mean() + 0.5 == pytest.approx(190.25, abs=0.3)
    assert y.mean() + 0.5 == pytest.approx(50.75, abs=0.3)


def test_disc_holds_the_suns_light(make_frame, make_scene):
    quiet = replace(SENSOR, sun_scatter=0.0, aperture_blades=0)
    camera = Camera(256, 192, 3000.0, 3000.0, 128.0, 96.0)  # disc of 28 px
    scene = make_scene(quiet, ExposureSpec(1e-4), SunSpec((0.0, 0.0, 1.0)), camera)
    rate = form_image(_black(make_frame), scene, 1e-4, camera)
    from proxnav.sensor.photometry import electrons_per_radiance

    radiance_sum = (electrons_per_radiance(quiet) * scene.sun.irradiance).sum() * camera.fx**2
    assert rate.sum() == pytest.approx(radiance_sum, rel=0.02)


def test_scattered_light_integrates_to_the_share_scattered():
    # over a half space seen by a very wide camera: integral of the distribution over solid angle is one
    camera = Camera(1201, 1201, 30.0, 30.0, 600.5, 600.5)
    sun = flare.SunInLens(np.array([0.0, 0.0, 1.0]), np.array([600.5, 600.5]), np.ones(3))
    shape = flare.scatter(Window(0, 0, 1201, 1201), camera, sun)
    y, x = (np.mgrid[:1201, :1201] + 0.5 - 600.5) / 30.0
    solid_angle = 1.0 / 30.0**2 / (1.0 + x**2 + y**2) ** 1.5
    centre = np.s_[595:606, 595:606]  # the plateau is finer than a pixel: counted on a finer grid
    fine = Camera(1100, 1100, 3000.0, 3000.0, 550.0, 550.0)
    inner = flare.scatter(Window(0, 0, 1100, 1100), fine, replace(sun, centre_px=np.array([550.0, 550.0])))
    v, u = (np.mgrid[:1100, :1100] + 0.5 - 550.0) / 3000.0
    outer = (shape * solid_angle).sum() - (shape * solid_angle)[centre].sum()
    total = outer + (inner / 3000.0**2 / (1.0 + u**2 + v**2) ** 1.5).sum()
    assert total == pytest.approx(1.0, abs=0.03)


def test_odd_irises_have_twice_as_many_spikes_as_blades():
    sun = flare.SunInLens(np.array([0.0, 0.0, 1.0]), np.array([500.0, 500.0]), np.ones(3))
    camera = Camera(1000, 1000, 1400.0, 1400.0, 500.0, 500.0)
    for blades, spikes in ((5, 10), (6, 6), (7, 14)):
        shape = flare.starburst(Window(0, 0, 1000, 1000), camera, camera, replace(SENSOR, aperture_blades=blades), sun)
        angle = np.linspace(0.0, 2.0 * np.pi, 3600, endpoint=False)
        ring = shape[(500 + 350 * np.sin(angle)).astype(int), (500 + 350 * np.cos(angle)).astype(int)]
        bright = ring > 0.2 * ring.max()
        assert (bright & ~np.roll(bright, 1)).sum() == spikes


def test_spike_falls_with_the_square_of_the_angle():
    sun = flare.SunInLens(np.array([0.0, 0.0, 1.0]), np.array([500.0, 500.0]), np.ones(3))
    camera = Camera(1000, 1000, 1400.0, 1400.0, 500.0, 500.0)
    shape = flare.starburst(Window(0, 0, 1000, 1000), camera, camera, replace(SENSOR, aperture_blades=7), sun)
    y, x = np.mgrid[:1000, :1000] + 0.5 - 500.0
    r = np.hypot(x, y)
    # the flux through a ring of unit width falls as 1/r^2, whatever the blades' curvature
    flux = [shape[(r > at) & (r <= at + 4)].sum() for at in (100, 200, 400)]
    assert flux[0] / flux[1] == pytest.approx(4.0, rel=0.08)
    assert flux[1] / flux[2] == pytest.approx(4.0, rel=0.08)


def test_ghosts_lie_on_the_line_through_the_principal_point():
    sun_px = np.array([190.0, 60.0])
    direction = unit(CAMERA.unproject(sun_px))
    sun = flare.SunInLens(direction, sun_px, np.ones(3))
    across = np.array([-(sun_px - (128, 96))[1], (sun_px - (128, 96))[0]]) / np.linalg.norm(sun_px - (128, 96))
    drawn = flare.ghosts(WINDOW, CAMERA, SENSOR, sun)
    assert drawn
    for ghost in flare.lens_ghosts(SENSOR):
        place = (128, 96) + ghost.place * (sun_px - (128, 96))
        assert abs((place - (128, 96)) @ across) < 1e-9
    y, x = np.mgrid[:192, :256] + 0.5
    total = np.zeros((192, 256))
    for part in drawn:
        total[part.box] += part.shape
    offset = ((x - 128) * across[0] + (y - 96) * across[1])[total > 0]
    assert np.abs(offset).max() < 0.145 * 300 * 1.1


def test_no_sun_no_flare(make_frame, make_scene):
    eclipsed = _rate(make_frame, make_scene, _sun_at(190.0, 50.0, visible_fraction=0.0))
    behind = _rate(make_frame, make_scene, SunSpec((0.0, 0.0, -1.0)))
    hooded = _rate(make_frame, make_scene, SunSpec((np.sin(1.1), 0.0, np.cos(1.1))))  # 63 deg off
    assert not eclipsed.any()
    assert not behind.any()
    assert not hooded.any()


def test_stray_light_grows_as_the_sun_nears_the_field(make_frame, make_scene):
    angles = np.radians([55.0, 45.0, 35.0, 27.0])
    mean = [_rate(make_frame, make_scene, SunSpec((np.sin(a), 0.0, np.cos(a)))).mean() for a in angles]
    assert (np.diff(mean) > 0).all()


def test_a_target_before_the_sun_takes_its_flare_away(make_frame, make_scene):
    cover = np.zeros((192, 256))
    cover[30:70, 170:210] = 1.0
    sun = _sun_at(190.0, 50.0)
    assert not _rate(make_frame, make_scene, sun, coverage=cover).any()
    half = np.zeros((192, 256))
    half[:, :190] = 1.0
    free = _rate(make_frame, make_scene, sun)
    assert _rate(make_frame, make_scene, sun, coverage=half)[150, 240] == pytest.approx(0.5 * free[150, 240], rel=0.2)


def test_a_window_sees_the_flare_of_the_full_frame(make_frame, make_scene):
    sun = _sun_at(190.0, 50.0)
    scene = make_scene(SENSOR, ExposureSpec(1e-4), sun)
    full = expose(_black(make_frame), scene).image
    part = expose(make_frame(np.zeros((64, 96)), corner=(20, 100)), scene).image
    np.testing.assert_array_equal(part, full[100:164, 20:116])


def test_levels_are_those_of_a_good_lens(make_frame, make_scene):
    """5 deg from the Sun the stray light is below a sunlit white wall's and above a thousandth of it."""
    scene = make_scene(SENSOR, ExposureSpec(1e-4), _sun_at(128.0, 96.0))
    rate = form_image(_black(make_frame), scene, 1e-4, CAMERA)
    from proxnav.sensor.photometry import electrons_per_radiance

    white = (electrons_per_radiance(SENSOR) * scene.sun.irradiance).sum() * 0.8 / np.pi
    y, x = np.mgrid[:192, :256] + 0.5
    ring = np.abs(np.hypot(x - 128, y - 96) / 300.0 - np.tan(np.radians(5.0))) < 1.0 / 300.0
    level = np.median(rate[ring]) / white
    assert 1e-3 < level < 1.0
    assert SUN_HALF_ANGLE * 300.0 > 1.0
