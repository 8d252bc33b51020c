"""Cameras by name and cameras drawn at random."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.records import ExposureSpec, Window
from proxnav.sensor.colour import demosaic, mosaic
from proxnav.sensor.detector import read_out
from proxnav.sensor.presets import (
    CMV4000_CLASS,
    OWN_RANGES,
    SENSORS,
    SPEED_CLASS,
    SPEEDPLUS_CLASS,
    SensorRanges,
    draw_sensor,
    scaled_noise,
    sensor_by_name,
)


def test_every_preset_is_found_by_its_name():
    for name, sensor in SENSORS.items():
        assert sensor_by_name(name) is sensor
    with pytest.raises(InputError, match="speed-class"):
        sensor_by_name("kodak")


def test_drawn_cameras_lie_within_the_ranges_and_differ(rng):
    ranges = SensorRanges()
    drawn = [draw_sensor(rng, CMV4000_CLASS, ranges) for _ in range(200)]
    for name in ("full_well_e", "read_noise_e", "prnu", "dsnu_e", "psf_sigma_px", "dark_current_e_per_s"):
        low, high = getattr(ranges, name)
        values = np.array([getattr(sensor, name) for sensor in drawn])
        assert low <= values.min() < values.max() <= high
        assert np.unique(values).size == 200
    assert len({sensor.serial for sensor in drawn}) == 200
    assert all(0.4 <= sensor.quantum_efficiency[1] <= 0.75 for sensor in drawn)


def test_cameras_about_the_laboratorys_keep_its_noise(rng):
    ranges = OWN_RANGES[SPEEDPLUS_CLASS.name]
    drawn = [draw_sensor(rng, SPEEDPLUS_CLASS) for _ in range(200)]
    noise_dn = np.array([sensor.read_noise_e / (sensor.full_well_e / 255.0) for sensor in drawn])
    assert noise_dn.min() < 3.0
    assert noise_dn.max() > 9.0
    for name in ("black_level_dn", "exposure_bias"):
        low, high = getattr(ranges, name)
        values = np.array([getattr(sensor, name) for sensor in drawn])
        assert low <= values.min() < getattr(SPEEDPLUS_CLASS, name) < values.max() <= high


def test_the_laboratorys_camera_shows_the_measured_black_and_saturated_levels():
    window = Window(0, 0, 200, 200)
    dark, full = (
        read_out(np.full((200, 200), signal, np.float32), SPEEDPLUS_CLASS, ExposureSpec(), 1e-3, window, (200, 200))
        for signal in (0.0, 20_000.0)
    )
    assert dark.mean() == pytest.approx(32.0, abs=0.3)
    assert dark.std() == pytest.approx(6.9, abs=0.15)  # DN, as in the photographs
    assert 249.0 < full.mean() < 254.0  # photographs: 248 to 252


def test_same_generator_draws_the_same_camera():
    one, other = (draw_sensor(np.random.default_rng(3), SPEED_CLASS) for _ in range(2))
    assert one == other


@pytest.mark.parametrize("k", [0.5, 2.0, 4.0])
def test_scaled_noise_is_k_times_as_strong_and_as_bright(k):
    base = replace(SPEED_CLASS, bits=12, hot_pixel_share=0.0, particle_rate_cm2_s=0.0, gain_e_per_dn=8.0, prnu=0.0)
    base = replace(base, dark_current_e_per_s=0.0, black_level_dn=100.0)
    images = []
    for sensor in (base, scaled_noise(base, k)):
        signal = np.full((300, 300), 8000.0 * sensor.quantum_efficiency[1] / base.quantum_efficiency[1], np.float32)
        image = read_out(signal, sensor, ExposureSpec(), 1e-3, Window(0, 0, 300, 300), (300, 300))
        images.append(image.astype(float))
    assert images[1].mean() == pytest.approx(images[0].mean(), rel=2e-3)
    assert images[1].std() == pytest.approx(k * images[0].std(), rel=0.02)


def test_noise_cannot_be_scaled_by_nothing():
    with pytest.raises(InputError, match="positive"):
        scaled_noise(SPEED_CLASS, 0.0)


@pytest.mark.parametrize("corner", [(0, 0), (1, 0), (0, 1), (1, 1)])
def test_demosaic_brings_back_an_even_colour(corner):
    colour = np.broadcast_to(np.array([200.0, 120.0, 40.0], np.float32), (20, 20, 3))
    window = Window(*corner, 20, 20)
    rgb = demosaic(mosaic(colour, window).astype(np.uint8), window)
    np.testing.assert_array_equal(rgb[4:-4, 4:-4], np.broadcast_to([200, 120, 40], (12, 12, 3)))
