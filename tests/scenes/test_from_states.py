"""A scene of two states is that of a trajectory's instant."""

from dataclasses import replace

import numpy as np

from proxnav.geometry import Camera
from proxnav.scenes.from_states import CraftState, scene_from_states
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.trajectories import HoldConfig, hold

CAMERA = Camera(width=64, height=64, fx=88.0, fy=88.0, cx=32.0, cy=32.0)


def test_two_states_give_the_scene_of_the_trajectory_that_they_are_taken_from() -> None:
    flight = hold(HoldConfig(duration_s=20.0, step_s=10.0))
    target = CraftState(flight.r_eci_target_m[0], flight.v_eci_target_mps[0], flight.q_eci_target[0])
    camera = CraftState(flight.r_eci_chaser_m[0], flight.v_eci_chaser_mps[0], flight.q_eci_cam[0])
    ours = scene_from_states(target, camera, CAMERA, flight.epoch_utc, index=3, seed=5)
    config = SceneConfig()
    theirs = scene_at(flight, 0, index=3, target="space-rider", camera=CAMERA, config=config, seed=5)
    np.testing.assert_allclose(ours.q_cam_target, theirs.q_cam_target, atol=1e-12)
    np.testing.assert_allclose(ours.t_cam_target_m, theirs.t_cam_target_m, atol=1e-6)  # m
    np.testing.assert_allclose(ours.sun.direction_target, theirs.sun.direction_target, atol=1e-12)
    assert ours.sun.visible_fraction == theirs.sun.visible_fraction
    assert ours.exposure.seed == theirs.exposure.seed
    lit_from_z = scene_from_states(target, camera, CAMERA, flight.epoch_utc, sun_eci=np.array([0.0, 0.0, 2.0]))
    assert replace(lit_from_z, sun=ours.sun, exposure=ours.exposure, index=3) == replace(ours, index=3)
    assert lit_from_z.sun.direction_target != ours.sun.direction_target
