"""Scenes of a trajectory: geometry in the target's frame, motion, Earth and Sun."""

import json

import numpy as np
import pytest

from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.celestial import q_eci_ecef
from proxnav.records import SceneSpec, Trajectory
from proxnav.scenes import SceneConfig, scene_at
from proxnav.scenes.from_trajectory import apparent_velocity, camera_rate

CAMERA = Camera(1024, 1024, 1407.0, 1407.0, 512.0, 512.0)
N = 1.13137e-3
RADIUS = 6778137.0


def orbiting(dt=1.0, count=5):
    """A target LVLH-fixed on an equatorial orbit, a chaser 30 m behind that keeps looking ahead."""
    t = dt * np.arange(count)
    u = N * t
    ahead, up = np.stack([-np.sin(u), np.cos(u), 0 * u], -1), np.stack([np.cos(u), np.sin(u), 0 * u], -1)
    z = np.tile([0.0, 0.0, 1.0], (count, 1))
    lvlh = quaternion.from_matrix(np.stack([ahead, -z, -up], axis=-1))
    cam = quaternion.from_matrix(np.stack([-z, -up, ahead], axis=-1))
    return Trajectory(
        epoch_utc="2024-11-01T00:00:00Z",
        t=t,
        r_eci_target_m=RADIUS * up,
        v_eci_target_mps=RADIUS * N * ahead,
        q_eci_target=lvlh,
        r_eci_chaser_m=RADIUS * up - 30.0 * ahead,
        v_eci_chaser_mps=RADIUS * N * ahead + 30.0 * N * up,
        q_eci_cam=cam,
        sun_eci=np.tile([0.6, 0.8, 0.0], (count, 1)),
        sun_visible=np.full(count, 0.25),
    )


def scene(k=2, **changes):
    return scene_at(orbiting(), k, index=9, target="space-rider", camera=CAMERA, config=SceneConfig(**changes), seed=4)


def test_the_target_stands_ahead_with_nadir_down():
    T = scene().T_cam_target
    assert T.t_m == pytest.approx([0.0, 0.0, 30.0], abs=1e-6)
    assert T.R @ np.array([0.0, 0.0, 1.0]) == pytest.approx([0.0, 1.0, 0.0], abs=1e-9)
    assert T.R @ np.array([1.0, 0.0, 0.0]) == pytest.approx([0.0, 0.0, 1.0], abs=1e-9)


def test_earth_lies_below_the_belly_and_turns_with_sidereal_time():
    spec = scene()
    assert spec.earth.r_target_earth_m == pytest.approx((0.0, 0.0, RADIUS), abs=1e-3)
    q_eci_target = quaternion.conjugate(np.array(spec.q_target_eci))
    q_ecef = quaternion.multiply(q_eci_target, np.array(spec.earth.q_target_ecef))
    assert quaternion.angle_between(q_ecef, q_eci_ecef("2024-11-01T00:00:00Z", np.array([2.0]))[0]) < 1e-12


def test_the_sun_is_turned_into_target_axes_and_scaled_by_distance():
    spec = scene()
    eci = quaternion.rotate(quaternion.conjugate(np.array(spec.q_target_eci)), np.array(spec.sun.direction_target))
    assert eci == pytest.approx([0.6, 0.8, 0.0])
    assert spec.sun.visible_fraction == 0.25
    assert sum(spec.sun.irradiance) == pytest.approx(530.0 / 0.9925**2, rel=2e-3)  # 1 November: 0.9925 au


@pytest.mark.parametrize("k", [0, 2, 4])
def test_the_camera_rate_is_the_orbital_rate(k):
    assert camera_rate(orbiting(), k) == pytest.approx([-N, 0.0, 0.0], abs=1e-12)  # -x of the camera is the normal


def test_the_apparent_velocity_is_the_derivative_of_the_position_in_the_picture():
    trajectory = orbiting()
    moved = trajectory.T_cam_target(3).t_m - trajectory.T_cam_target(1).t_m
    assert apparent_velocity(trajectory, 2) == pytest.approx(moved / 2.0, abs=1e-6)
    assert scene().exposure.v_cam_target_mps == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_a_single_instant_has_no_rate():
    assert camera_rate(orbiting(count=1), 0).tolist() == [0.0, 0.0, 0.0]


def test_noise_follows_seed_and_index_and_the_spec_survives_json():
    assert scene() == scene()
    again = scene_at(orbiting(), 2, index=10, target="x", camera=CAMERA, config=SceneConfig(), seed=4)
    assert again.exposure.seed != scene().exposure.seed
    assert SceneSpec.from_json(json.loads(json.dumps(scene().to_json()))) == scene()


def test_options_reach_the_spec():
    assert scene(earth=False).earth is None
    spec = scene(cloud_cover=0.1, cloud_seed=5, sequence="wse", exposure_s=0.01)
    assert (spec.earth.cloud_cover, spec.earth.cloud_seed, spec.sequence) == (0.1, 5, "wse")
    assert spec.exposure.exposure_s == 0.01
    assert (spec.t, spec.epoch_utc, spec.index) == (2.0, "2024-11-01T00:00:00Z", 9)


def test_an_instant_outside_is_refused():
    with pytest.raises(InputError, match="which has 5 instants"):
        scene(k=5)
    assert scene(k=-1).t == 4.0
