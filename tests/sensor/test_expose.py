"""The chain from radiance to digital numbers, effect by effect."""

from dataclasses import replace

import numpy as np
import pytest

from proxnav.geometry import Camera
from proxnav.records import ExposureSpec, SensorSpec, Window
from proxnav.records.scene import SUN_IRRADIANCE
from proxnav.sensor import detector, expose
from proxnav.sensor.expose import form_image
from proxnav.sensor.layers import defocus_m
from proxnav.sensor.photometry import electrons_per_radiance
from proxnav.sensor.presets import SPEED_CLASS

SHAPE = (192, 256)
CAMERA = Camera(width=256, height=192, fx=300.0, fy=300.0, cx=128.0, cy=96.0)
QUIET = SensorSpec(bits=12)
NOISY = replace(SPEED_CLASS, flare=False, veiling_glare=0.0, psf_sigma_px=0.0, halo=0.0, hot_pixel_share=1e-3)


def _radiance_for(electrons: float, sensor: SensorSpec, exposure_s: float) -> float:
    """Sum over the bands [W/(m^2 sr)], split evenly, that gives a pixel on the axis so many electrons."""
    return electrons / exposure_s / electrons_per_radiance(sensor).mean()


def test_sunlit_plate_reaches_16_ke_in_the_time_of_the_photometric_reference(make_frame, make_scene):
    # Lambertian plate of albedo 0.2 at normal incidence: 530 W/m^2 in 400-700 nm, f/4, tau 0.85, QE 0.65: 0.18 ms
    sensor = replace(QUIET, quantum_efficiency=(0.65, 0.65, 0.65), gain_e_per_dn=10.0)
    radiance = np.broadcast_to(0.2 * np.array(SUN_IRRADIANCE) / np.pi, (64, 64, 3))
    exposure = expose(make_frame(radiance), make_scene(sensor, ExposureSpec(exposure_s=0.184e-3)))
    assert exposure.image.mean() * 10.0 == pytest.approx(16_000.0, rel=0.10)


def test_same_seed_gives_the_same_bytes(make_frame, make_scene, rng):
    frame = make_frame(rng.random(SHAPE) * 50.0)
    scene = make_scene(NOISY, ExposureSpec(exposure_s=2e-4, seed=5))
    assert expose(frame, scene).image.tobytes() == expose(frame, scene).image.tobytes()


def test_another_frame_changes_the_temporal_noise_but_not_the_pattern(make_frame, make_scene):
    frame = make_frame(np.full(SHAPE, 30.0))
    sensor = replace(QUIET, prnu=0.05, black_level_dn=50.0, read_noise_e=20.0)
    stack = np.array([expose(frame, make_scene(sensor, ExposureSpec(2e-4, seed=s))).image for s in range(40)], float)
    assert not np.array_equal(stack[0], stack[1])
    one, other = stack[:20].mean(axis=0), stack[20:].mean(axis=0)
    assert np.corrcoef(one.ravel(), other.ravel())[0, 1] > 0.95
    noise = stack[0] - stack[1], stack[2] - stack[3]
    assert abs(np.corrcoef(noise[0].ravel(), noise[1].ravel())[0, 1]) < 4.0 / np.sqrt(noise[0].size)


def test_another_serial_is_another_pattern(make_frame, make_scene):
    frame = make_frame(np.full(SHAPE, 30.0))
    sensors = [replace(QUIET, prnu=0.2, serial=serial, full_well_e=1e5) for serial in (0, 1)]
    one, other = (expose(frame, make_scene(sensor, ExposureSpec(1e-3))).image.ravel() for sensor in sensors)
    assert abs(np.corrcoef(one, other)[0, 1]) < 0.05


@pytest.mark.parametrize("colour", [False, True])
def test_a_window_is_read_like_that_region_of_the_full_frame(make_frame, make_scene, rng, colour):
    radiance = rng.random((*SHAPE, 3)) * 30.0
    sensor = replace(NOISY, colour=colour, particle_rate_cm2_s=3e4, dark_current_e_per_s=5e4, bits=12)
    scene = make_scene(sensor, ExposureSpec(exposure_s=2e-4, seed=9))
    full = expose(make_frame(radiance), scene).image
    x, y, w, h = 37, 51, 64, 48
    part = expose(make_frame(radiance[y : y + h, x : x + w], corner=(x, y)), scene).image
    assert (part == full[y : y + h, x : x + w]).mean() > 0.99  # charge that blooms over the border is missing
    inner = np.s_[4:-4, 4:-4]
    np.testing.assert_array_equal(part[inner], full[y : y + h, x : x + w][inner])


def test_photo_electrons_have_poisson_mean_and_variance(make_frame, make_scene):
    sensor = replace(QUIET, gain_e_per_dn=1.0, full_well_e=4000.0)
    level = _radiance_for(900.0, sensor, 1e-3)
    image = expose(make_frame(np.full((400, 400), level)), make_scene(sensor)).image.astype(float)
    assert image.mean() == pytest.approx(900.0, rel=1e-3)
    assert image.var() == pytest.approx(900.0, rel=0.015)


def test_read_noise_and_fixed_offsets_have_their_sizes(make_frame, make_scene):
    dark = make_frame(np.zeros((300, 300)))
    sensor = replace(QUIET, gain_e_per_dn=0.5, black_level_dn=400.0, read_noise_e=7.0)
    noise = expose(dark, make_scene(sensor)).image.astype(float)
    assert noise.std() * 0.5 == pytest.approx(7.0, rel=0.02)
    fixed = expose(dark, make_scene(replace(sensor, read_noise_e=0.0, dsnu_e=3.0))).image.astype(float)
    assert fixed.std() * 0.5 == pytest.approx(3.0, rel=0.02)


def test_rows_and_columns_have_offsets_of_their_own(make_frame, make_scene):
    dark = make_frame(np.zeros((1000, 1000)))
    base = replace(QUIET, black_level_dn=100.0)
    rows = expose(dark, make_scene(replace(base, row_noise_dn=10.0))).image.astype(float)
    columns = expose(dark, make_scene(replace(base, column_noise_dn=10.0))).image.astype(float)
    assert np.ptp(rows, axis=1).max() == 0.0
    assert np.ptp(columns, axis=0).max() == 0.0
    assert rows[:, 0].std() == pytest.approx(10.0, rel=0.1)
    assert columns[0].std() == pytest.approx(10.0, rel=0.1)


def test_dark_current_doubles_with_temperature():
    sensor = replace(QUIET, dark_current_e_per_s=100.0, dark_reference_c=25.0, dark_doubling_c=7.0)
    at = [detector.dark_electrons(sensor, ExposureSpec(temperature_c=t), 0.5) for t in (25.0, 32.0, 11.0)]
    np.testing.assert_allclose(at, [50.0, 100.0, 12.5])


def test_dark_charge_is_poisson_and_hot_pixels_are_rare_and_bright(make_frame, make_scene):
    dark = make_frame(np.zeros((500, 500)))
    sensor = replace(QUIET, dark_current_e_per_s=40.0, gain_e_per_dn=1.0, full_well_e=4095.0)
    image = expose(dark, make_scene(sensor, ExposureSpec(1.0, temperature_c=25.0))).image.astype(float)
    assert image.mean() == pytest.approx(40.0, rel=5e-3)
    assert image.var() == pytest.approx(40.0, rel=0.02)
    hot = expose(dark, make_scene(replace(sensor, hot_pixel_share=1e-3), ExposureSpec(1.0, temperature_c=25.0))).image
    assert (hot > 1000).mean() == pytest.approx(1e-3, rel=0.25)


def test_dead_pixels_are_rare_dark_and_always_the_same(make_frame, make_scene):
    lit, sensor = make_frame(np.full((500, 500), 10.0)), replace(QUIET, dead_pixel_share=1e-3)
    first, second = (expose(lit, make_scene(sensor, ExposureSpec(1e-3, seed=seed))).image for seed in (1, 2))
    assert (first == 0).mean() == pytest.approx(1e-3, rel=0.25)
    assert ((first == 0) == (second == 0)).all()
    other = expose(lit, make_scene(replace(sensor, serial=9), ExposureSpec(1e-3))).image
    assert ((first == 0) != (other == 0)).any()


def test_cos4_falls_as_the_fourth_power_of_the_cosine(make_frame, make_scene):
    camera = Camera(201, 201, 100.0, 100.0, 100.5, 100.5)
    sensor = replace(QUIET, cos4=True, full_well_e=1e9, gain_e_per_dn=1e4, bits=16)
    image = expose(make_frame(np.full((201, 201), 1e5)), make_scene(sensor, camera=camera)).image.astype(float)
    # 100 px off the axis at f = 100 px is 45 deg: cos^4 = 1/4; the corner is at tan^2 = 2: 1/9
    assert image[100, 200] / image[100, 100] == pytest.approx(0.25, rel=2e-3)
    assert image[0, 0] / image[100, 100] == pytest.approx(1.0 / 9.0, rel=2e-3)


def test_translation_blurs_by_v_t_f_over_z(make_frame, make_scene):
    radiance, cover = np.zeros(SHAPE), np.zeros(SHAPE)
    cover[60:130, 80:170] = 1.0
    radiance[95, 125] = 1e3
    exposure = ExposureSpec(exposure_s=0.1, v_cam_target_mps=(2.0, 0.0, 0.0))  # 2 * 0.1 * 300 / 10 = 6 px
    image = form_image(make_frame(radiance, cover), make_scene(QUIET, exposure), 0.1, CAMERA)
    x = np.arange(SHAPE[1])
    profile = image.sum(axis=0) / image.sum()
    mean = (profile * x).sum()
    length = np.sqrt(12.0 * (profile * (x - mean) ** 2).sum())
    assert mean == pytest.approx(125.0, abs=0.02)
    assert length == pytest.approx(6.0, rel=0.02)


def test_a_turning_camera_smears_the_background_and_not_a_target_it_follows(make_frame, make_scene):
    radiance, cover = np.zeros(SHAPE), np.zeros(SHAPE)
    cover[60:130, 80:170] = 1.0
    radiance[95, 125] = radiance[30, 125] = 1e3
    sensor = replace(QUIET, full_well_e=1e9, gain_e_per_dn=1e4, bits=16)
    exposure = ExposureSpec(exposure_s=0.1, omega_cam_radps=(0.0, 0.2, 0.0))  # 0.02 rad: 6 px at the centre
    image = expose(make_frame(radiance, cover), make_scene(sensor, exposure)).image.astype(float)
    assert (image[95] > 100).sum() == 1
    assert 6 <= (image[30] > 100).sum() <= 8


def test_defocus_follows_the_thin_lens():
    # f = 16 mm, f/4, focus 50 m, target at 10 m: 5.1 um
    sensor = replace(QUIET, f_number=4.0, focus_m=50.0)
    assert defocus_m(10.0, sensor, 0.016) == pytest.approx(5.1e-6, rel=0.01)
    assert defocus_m(50.0, sensor, 0.016) == 0.0
    assert defocus_m(10.0, replace(sensor, focus_m=0.0), 0.016) == 0.0


def test_a_target_out_of_focus_keeps_its_light(make_frame, make_scene):
    radiance, cover = np.zeros(SHAPE), np.zeros(SHAPE)
    cover[90:100, 120:136] = 1.0
    radiance[cover > 0] = 1e3
    sensor = replace(QUIET, focus_m=100.0, f_number=1.0, full_well_e=1e9, gain_e_per_dn=1e3, bits=16)
    camera = Camera(256, 192, 8000.0, 8000.0, 128.0, 96.0)
    frame = make_frame(radiance, cover, depth_m=50.0)
    blurred = expose(frame, make_scene(sensor, camera=camera)).image.astype(float)
    sharp = expose(frame, make_scene(replace(sensor, focus_m=0.0), camera=camera)).image.astype(float)
    assert blurred.sum() == pytest.approx(sharp.sum(), rel=5e-3)
    assert (blurred > 5).sum() > 1.5 * (sharp > 5).sum()


def test_veiling_glare_and_halo_conserve_the_light(make_frame, make_scene):
    radiance = np.full(SHAPE, 1.0)
    radiance[80:110, 100:140] = 40.0
    sensor = replace(QUIET, full_well_e=1e5, gain_e_per_dn=2.0, bits=16)
    plain, veiled, haloed = (
        expose(make_frame(radiance), make_scene(s, ExposureSpec(2e-4))).image.astype(float)
        for s in (sensor, replace(sensor, veiling_glare=0.05), replace(sensor, halo=0.2))
    )
    assert veiled.sum() == pytest.approx(plain.sum(), rel=1e-3)
    assert haloed.sum() == pytest.approx(plain.sum(), rel=1e-3)
    added = veiled[:50] - plain[:50] * 0.95
    assert added.mean() == pytest.approx(0.05 * plain.mean(), rel=0.02)
    assert haloed[75, 120] > 1.5 * plain[75, 120]
    assert haloed[10, 10] == pytest.approx(plain[10, 10], rel=0.15)


def test_full_well_clips_and_the_share_of_full_pixels_is_told(make_frame, make_scene):
    radiance = np.full(SHAPE, 1.0)
    radiance[:, :64] = 1e4
    exposure = expose(make_frame(radiance), make_scene(SensorSpec(bits=8)))
    assert exposure.image.max() == 255
    assert exposure.saturated_share == pytest.approx(0.25)
    assert exposure.white_dn == 255


@pytest.mark.parametrize(("bits", "dtype"), [(8, np.uint8), (10, np.uint16), (12, np.uint16), (16, np.uint16)])
def test_depth_of_the_converter_sets_type_and_range(make_frame, make_scene, bits, dtype):
    image = expose(make_frame(np.full((32, 32), 1e5)), make_scene(SensorSpec(bits=bits))).image
    assert image.dtype == dtype
    assert image.max() == 2**bits - 1


def test_bayer_pixels_see_their_band_wherever_the_window_starts(make_frame, make_scene):
    radiance = np.zeros((16, 16, 3))
    radiance[..., 0] = 100.0
    for corner in ((0, 0), (1, 0), (0, 1), (3, 5)):
        image = expose(make_frame(radiance, corner=corner), make_scene(SensorSpec(colour=True))).image
        y, x = np.mgrid[:16, :16]
        red = ((y + corner[1]) % 2 == 0) & ((x + corner[0]) % 2 == 0)
        assert image[red].min() > 0
        assert image[~red].max() == 0


def test_exposure_given_wins_over_the_scene_and_zero_asks_the_sensor(make_frame, make_scene):
    frame = make_frame(np.full(SHAPE, 30.0))
    scene = make_scene(SPEED_CLASS, ExposureSpec(exposure_s=1e-4))
    assert expose(frame, scene, exposure_s=3e-4).exposure_s == 3e-4
    assert expose(frame, scene).exposure_s == 1e-4
    chosen = expose(frame, make_scene(SPEED_CLASS, ExposureSpec(exposure_s=0.0)))
    assert 0.5 < np.percentile(chosen.image, 98) / 255 < 0.7


def test_a_crop_at_half_resolution_is_blurred_by_half_the_pixels(make_frame, make_scene):
    radiance = np.zeros((64, 64))
    radiance[32, 32] = 1e6
    sensor = replace(QUIET, psf_sigma_px=2.0, full_well_e=1e9, gain_e_per_dn=1e4, bits=16)
    scene = make_scene(sensor)
    image = expose(make_frame(radiance), scene, camera=scene.camera.resized(128, 96)).image.astype(float)
    x = np.arange(64) - 32
    assert (image.sum(axis=0) / image.sum() * x**2).sum() == pytest.approx(1.0, rel=0.02)  # px^2


def test_arguments_are_left_as_they_were(make_frame, make_scene, rng):
    frame = make_frame(rng.random(SHAPE) * 50.0)
    before = frame.radiance.copy(), frame.coverage.copy()
    expose(frame, make_scene(replace(SPEED_CLASS, focus_m=30.0)))
    np.testing.assert_array_equal(frame.radiance, before[0])
    np.testing.assert_array_equal(frame.coverage, before[1])


def test_particle_tracks_have_the_expected_charge(make_scene):
    from proxnav.sensor.particles import CHARGE_E_PER_M, add_tracks, mean_count

    sensor = replace(QUIET, particle_rate_cm2_s=1e4, readout_s=0.05)
    size = (1000, 800)
    expected = mean_count(sensor, 0.0, size)
    assert expected == pytest.approx(1e4 * 0.8e6 * (5.86e-4) ** 2 * 0.05)
    charges = []
    for seed in range(10):
        electrons = np.zeros((800, 1000), dtype=np.float32)
        add_tracks(electrons, sensor, seed, 0.0, Window(0, 0, 1000, 800), size)
        charges.append(float(electrons.sum()))
    # length Exp(5 px) clipped to 1-60 px: mean 5 exp(-1/5) + 1
    per_track = CHARGE_E_PER_M * 5.86e-6 * (5.0 * np.exp(-0.2) + 1.0)
    assert np.mean(charges) == pytest.approx(expected * per_track, rel=0.06)


def test_blooming_conserves_charge_while_there_is_room():
    from proxnav.sensor.blooming import spill

    electrons = np.full((41, 41), 100.0, dtype=np.float32)
    electrons[20, 20] = 5_000.0
    total = electrons.sum()
    spilled = electrons.copy()
    spill(spilled, 1000.0, 1.0)
    assert spilled.sum() == pytest.approx(total, rel=1e-4)
    assert spilled.max() <= 1000.0
    np.testing.assert_allclose(spilled, spilled.T, rtol=1e-5)
    clipped = electrons.copy()
    spill(clipped, 1000.0, 0.0)
    assert clipped.sum() == pytest.approx(total - 4000.0)
