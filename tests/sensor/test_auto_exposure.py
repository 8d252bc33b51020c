"""Exposure chosen at once, and controlled in a sequence."""

import numpy as np
import pytest

from proxnav.records import ExposureSpec, SensorSpec
from proxnav.sensor import AutoExposure, ControlState, choose_exposure, control_exposure, expose, measure_level


def test_the_metered_percentile_lands_at_the_level(make_frame, make_scene, rng):
    frame = make_frame(rng.random((200, 200)) * 60.0)
    control = AutoExposure(percentile=95.0, level=0.5)
    scene = make_scene(SensorSpec(bits=12, full_well_e=1e5))
    exposure_s = choose_exposure(frame, scene, control)
    image = expose(frame, scene, exposure_s).image
    assert np.percentile(image, 95.0) / 4095 == pytest.approx(0.5, rel=0.01)


def test_the_target_is_metered_rather_than_a_bright_background(make_frame, make_scene):
    radiance, cover = np.full((100, 100), 100.0), np.zeros((100, 100))
    cover[40:60, 40:60] = 1.0
    radiance[cover > 0] = 10.0
    scene = make_scene(SensorSpec())
    by_target = choose_exposure(make_frame(radiance, cover), scene)
    by_box = choose_exposure(make_frame(radiance), scene, box_xyxy=np.array([40.0, 40.0, 60.0, 60.0]))
    by_frame = choose_exposure(make_frame(radiance), scene)
    assert by_target == pytest.approx(10.0 * by_frame)
    assert by_box == pytest.approx(by_target)


def test_an_exposure_bias_lengthens_the_exposure_by_its_factor(make_frame, make_scene):
    frame = make_frame(np.full((9, 9), 10.0))
    plain, biased = (choose_exposure(frame, make_scene(SensorSpec(exposure_bias=bias))) for bias in (1.0, 3.0))
    assert biased == pytest.approx(3.0 * plain)


def test_exposure_stays_within_its_limits(make_frame, make_scene):
    control = AutoExposure(shortest_s=1e-4, longest_s=1e-3)
    scene = make_scene(SensorSpec())
    assert choose_exposure(make_frame(np.full((9, 9), 1e6)), scene, control) == 1e-4
    assert choose_exposure(make_frame(np.full((9, 9), 1e-3)), scene, control) == 1e-3
    assert choose_exposure(make_frame(np.zeros((9, 9))), scene, control) == 1e-3


@pytest.mark.parametrize("lag", [0, 1, 2])
def test_controller_settles_at_the_level_after_a_step_of_light(lag):
    control = AutoExposure(lag_frames=lag, level=0.6)
    state = ControlState(exposure_s=1e-4)
    levels = []
    for k in range(60):
        brightness = 6000.0 if k < 30 else 1500.0
        levels.append(min(brightness * state.exposure_s, 1.0))
        state = control_exposure(state, levels[-1], control)
    assert levels[29] == pytest.approx(0.6, rel=0.03)
    assert levels[-1] == pytest.approx(0.6, rel=0.03)


def test_a_decision_takes_effect_after_the_lag():
    control = AutoExposure(lag_frames=2)
    state = ControlState(exposure_s=1e-4)
    first = control_exposure(state, 0.1, control)
    second = control_exposure(first, 0.1, control)
    third = control_exposure(second, 0.1, control)
    assert first.exposure_s == second.exposure_s == 1e-4
    assert third.exposure_s > 1e-4


def test_controller_comes_back_from_a_limit_at_once():
    control = AutoExposure(lag_frames=0, longest_s=1e-3)
    state = ControlState(exposure_s=1e-3)
    for _ in range(100):
        state = control_exposure(state, 0.01, control)
    assert state.exposure_s == 1e-3
    assert control_exposure(state, 1.0, control).exposure_s < 1e-3


def test_level_is_measured_above_black(make_frame, make_scene):
    sensor = SensorSpec(bits=10, black_level_dn=64.0)
    frame = make_frame(np.full((50, 50), 20.0))
    scene = make_scene(sensor, ExposureSpec(exposure_s=0.0))
    exposure = expose(frame, scene)
    assert measure_level(exposure.image, exposure.white_dn, 64.0) == pytest.approx(0.6, rel=0.03)
