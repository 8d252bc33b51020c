"""From where the camera looks: range, side, roll and the target's place in the picture."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.arrays import unit
from proxnav.geometry.pointing import q_a_cam_looking, q_between
from proxnav.geometry.types import Pixels, QuatWxyz, Vector3

_FORWARD, _ZENITH = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0])  # in LVLH axes


@dataclass(frozen=True)
class ViewpointConfig:
    """Viewpoints uniform on the sphere about the target."""

    range_m: tuple[float, float] = (10.0, 100.0)
    """Least and most distance from the camera to the target's origin."""
    range_spacing: Literal["uniform", "log"] = "uniform"
    """Distribution of that distance: uniform, or uniform in its logarithm, which gives near and far their share."""
    roll_limit_rad: float = np.pi
    """Most roll away from LVLH zenith up in the picture; pi is any roll."""
    partial_share: float = 0.1
    """Share of frames whose target may be cut by the picture's edge because its origin lies anywhere in it."""
    target_radius_m: float = 5.0
    """Radius that is kept inside the picture in the other frames, as far as the range allows."""
    least_offset: float = 0.1
    """Where the target fills the picture its origin still moves by this share of half the picture's size."""

    def __post_init__(self) -> None:
        low, high = self.range_m
        if not 0.0 < low <= high:
            raise InputError(f"range_m needs 0 < least <= most, found {self.range_m}")


def draw_view(rng: np.random.Generator, config: ViewpointConfig, camera: Camera, q_target_lvlh: QuatWxyz) -> Pose:
    """T_cam_target of one viewpoint."""
    range_m = _draw_range(rng, config)
    outward = unit(rng.normal(size=3))
    up, ahead = quaternion.rotate(q_target_lvlh, _ZENITH), quaternion.rotate(q_target_lvlh, _FORWARD)
    q_target_look = q_a_cam_looking(-outward, up, ahead)
    roll = rng.uniform(-1.0, 1.0) * config.roll_limit_rad
    ray = unit(camera.unproject(_draw_pixel(rng, config, camera, range_m)))
    shift = q_between(np.array([0.0, 0.0, 1.0]), ray)
    q_cam_look = quaternion.multiply(shift, quaternion.exp(np.array([0.0, 0.0, roll])))
    q_cam_target = quaternion.multiply(q_cam_look, quaternion.conjugate(q_target_look))
    return Pose.from_wxyz("cam", "target", q_cam_target, range_m * ray)


def _draw_range(rng: np.random.Generator, config: ViewpointConfig) -> float:
    if config.range_spacing == "log":
        return float(np.exp(rng.uniform(*np.log(config.range_m))))
    return rng.uniform(*config.range_m)


def sees_earth(T_cam_target: Pose, nadir_target: Vector3, camera: Camera, dip_rad: float) -> bool:
    """Whether any of a grid of pixels, edges included, looks below the horizon, `dip_rad` below the horizontal."""
    u, v = np.meshgrid(np.linspace(0.0, camera.width, 9), np.linspace(0.0, camera.height, 9))
    rays = unit(camera.unproject(np.stack([u, v], axis=-1).reshape(-1, 2)))
    depression = rays @ quaternion.rotate(T_cam_target.q_wxyz, nadir_target)  # sine; NaN rays compare false
    return bool((depression > np.sin(dip_rad)).any())


def _draw_pixel(rng: np.random.Generator, config: ViewpointConfig, camera: Camera, range_m: float) -> Pixels:
    """Where the target's origin appears."""
    half = 0.5 * np.array([camera.width, camera.height], dtype=np.float64)
    if rng.random() >= config.partial_share:
        reach = np.array([camera.fx, camera.fy]) * config.target_radius_m / range_m
        room = np.maximum(half - reach, config.least_offset * half)
    else:
        room = half
    return half + rng.uniform(-1.0, 1.0, size=2) * room
