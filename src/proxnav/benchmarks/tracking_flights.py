"""Frame sequences for trackers: the sunlit spiral and a tumble, scaled to the size of the target."""

from dataclasses import replace
from typing import Literal

import numpy as np

from proxnav.flight.attitude_motion import tumble
from proxnav.geometry import Camera
from proxnav.missions.flights import AFTERNOON, DAYLIGHT
from proxnav.records import SceneSpec, Trajectory
from proxnav.scenes.from_trajectory import SceneConfig, scene_at
from proxnav.sensor.presets import SPEED_CLASS
from proxnav.targets import Target
from proxnav.trajectories import OBSERVATION_10_100_STRICT, HoldConfig, hold, walking_safety_ellipse
from proxnav.trajectories.selection import clip_time, spread

Motion = Literal["spiral", "tumble"]

_SPIRAL_START_S, _SPIRAL_S = 3520.0, 1530.0
"""Longest piece of the spiral that is sunlit with the Sun behind the camera's half of the sky: 22 to 69 m."""
_STUDIED_SIZE_M = 6.526
"""Size of Space Rider, for which the spiral was made; other targets are seen from ranges in that proportion."""
TUMBLE_DEG_S = (1.0, 2.6, 1.1)
"""Inertial rate at the start, target axes: 3 deg/s, three times what the servicing studies count as tumbling."""
_TUMBLE_INERTIA = (1.0, 3.0, 3.2)


def tracking_scenes(
    motion: Motion, target: Target, name: str, camera: Camera, frames: int, seed: int
) -> list[SceneSpec]:
    """Scenes of a target that `name` loads: the lit piece of the spiral in `frames` steps, or a tumble at 1 Hz."""
    flight = spread(_flight(motion, target, frames), frames)
    look = SceneConfig(sensor=SPEED_CLASS, sequence=motion)
    return [
        scene_at(flight, k, index=k, target=name, camera=camera, config=look, seed=seed) for k in range(len(flight))
    ]


def _flight(motion: Motion, target: Target, frames: int) -> Trajectory:
    if motion == "spiral":
        path = walking_safety_ellipse(replace(OBSERVATION_10_100_STRICT, step_s=1.0), DAYLIGHT)
        return _in_proportion(clip_time(path, _SPIRAL_START_S, _SPIRAL_S), target)
    still = hold(HoldConfig(duration_s=float(frames - 1)), AFTERNOON)
    turning = tumble(still.q_eci_target[0], np.deg2rad(TUMBLE_DEG_S), _TUMBLE_INERTIA, still.t)
    return _in_proportion(replace(still, q_eci_target=turning), target)


def _in_proportion(flight: Trajectory, target: Target) -> Trajectory:
    """The flight with ranges in proportion to the target's size."""
    scale = target.size_m / _STUDIED_SIZE_M
    away = flight.r_eci_chaser_m - flight.r_eci_target_m
    drift = flight.v_eci_chaser_mps - flight.v_eci_target_mps
    return replace(
        flight,
        r_eci_chaser_m=flight.r_eci_target_m + scale * away,
        v_eci_chaser_mps=flight.v_eci_target_mps + scale * drift,
    )
