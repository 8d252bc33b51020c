"""Sensors that are turned against the camera give the same solution, once the filter knows how."""

from dataclasses import replace

import numpy as np
import pytest

from navigation.flights import CAMERA, fly, points
from proxnav.errors import InputError
from proxnav.geometry import quaternion
from proxnav.navigation.config import NavigationConfig
from proxnav.navigation.filter_setup import setup_of
from proxnav.navigation.mounting import Mounting, in_camera_axes
from proxnav.navigation.navigator import navigated
from proxnav.navigation.readings import StarFix
from proxnav.records import SensorRecords

GYRO, TRACKER = (0.5, 0.5, -0.5, 0.5), (np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0)


def in_own_axes(records: SensorRecords) -> SensorRecords:
    """Records as sensors turned by GYRO and TRACKER against the camera would write them."""
    assert records.gyro is not None
    assert records.star_tracker is not None
    rate = quaternion.rotate(quaternion.conjugate(np.array(GYRO)), records.gyro.rate)
    q = quaternion.multiply(records.star_tracker.q_eci_cam, np.array(TRACKER))
    sigma = np.full_like(records.star_tracker.sigma_rad, 1e-4)
    return replace(
        records, gyro=replace(records.gyro, rate=rate),
        star_tracker=replace(records.star_tracker, q_eci_cam=q, sigma_rad=sigma),
    )  # fmt: skip


def test_turned_sensors_give_the_same_solution() -> None:
    _, records = fly(seconds=40.0)
    assert records.star_tracker is not None
    alike = replace(records.star_tracker, sigma_rad=np.full_like(records.star_tracker.sigma_rad, 1e-4))
    straight = replace(records, star_tracker=alike)
    times = np.arange(10.0, 40.0, 10.0)
    mounted = NavigationConfig(mounting=Mounting(gyro=GYRO, star_tracker=TRACKER))
    plain = navigated(straight, setup_of(straight, points(), CAMERA, NavigationConfig()), times).states
    turned = navigated(in_own_axes(records), setup_of(records, points(), CAMERA, mounted), times).states
    for ours, theirs in zip(turned, plain, strict=True):
        assert ours is not None
        assert theirs is not None
        np.testing.assert_allclose(ours.r_ric_m, theirs.r_ric_m, atol=1e-7)
        np.testing.assert_allclose(ours.gyro_bias, theirs.gyro_bias, atol=1e-12)


def test_deviations_of_a_star_tracker_turn_with_it() -> None:
    fix = StarFix(0.0, 0.0, np.array([1.0, 0.0, 0.0, 0.0]), np.array([1.0, 2.0, 30.0]))
    turned = in_camera_axes(fix, Mounting(star_tracker=TRACKER))
    assert isinstance(turned, StarFix)
    np.testing.assert_allclose(turned.sigma_rad, [30.0, 2.0, 1.0], rtol=1e-12)


def test_a_mounting_that_is_no_rotation_is_refused() -> None:
    with pytest.raises(InputError, match="gyro needs a unit quaternion"):
        Mounting(gyro=(1.0, 1.0, 0.0, 0.0))
