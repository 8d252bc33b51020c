"""One instant of a trajectory as a scene: everything turned into the target's frame."""

from dataclasses import dataclass, field

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera, quaternion
from proxnav.geometry.celestial import ASTRONOMICAL_UNIT, q_eci_ecef, sun_distance_m
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import EarthSpec, ExposureSpec, SceneSpec, SensorSpec, SunSpec, TextureSpec, Trajectory
from proxnav.records.scene import SUN_IRRADIANCE
from proxnav.scenes.plain import quadruple, triple


@dataclass(frozen=True)
class SceneConfig:
    """What a trajectory does not say about its frames."""

    sensor: SensorSpec = field(default_factory=SensorSpec)
    exposure_s: float = 0.0
    """0 lets the sensor choose by its auto exposure."""
    temperature_c: float = 20.0
    texture: TextureSpec = field(default_factory=TextureSpec)
    earth: bool = True
    """False is a black sky without Earthshine."""
    cloud_cover: float = 0.5
    cloud_seed: int = 0
    atmosphere: bool = True
    city_lights: bool = True
    sequence: str = "trajectory"
    """Name of the sequence that the frames belong to."""


def scene_at(
    trajectory: Trajectory, k: int, *, index: int, target: str, camera: Camera, config: SceneConfig, seed: int
) -> SceneSpec:
    """The scene at instant `k`, as frame number `index`; (seed, index) fix the noise of its exposure."""
    if not -len(trajectory) <= k < len(trajectory):
        raise InputError(f"instant {k} is outside {trajectory.source}, which has {len(trajectory)} instants")
    k %= len(trajectory)
    T_cam_target = trajectory.T_cam_target(k)
    q_target_eci = quaternion.conjugate(trajectory.q_eci_target[k])
    return SceneSpec(
        index=index,
        target=target,
        camera=camera,
        q_cam_target=quadruple(T_cam_target.q_wxyz),
        t_cam_target_m=triple(T_cam_target.t_m),
        sun=_sun(trajectory, k, q_target_eci),
        earth=_earth(trajectory, k, q_target_eci, config) if config.earth else None,
        q_target_eci=quadruple(q_target_eci),
        texture=config.texture,
        sensor=config.sensor,
        exposure=_exposure(trajectory, k, config, _noise_seed(seed, index)),
        epoch_utc=trajectory.epoch_utc,
        t=float(trajectory.t[k]),
        sequence=config.sequence,
    )


def camera_rate(trajectory: Trajectory, k: int) -> Vector3:
    """Inertial rate of the camera in its own axes [rad/s], by central differences; zero for a single instant."""
    i, j = max(k - 1, 0), min(k + 1, len(trajectory) - 1)
    if i == j:
        return np.zeros(3)
    turn = quaternion.multiply(quaternion.conjugate(trajectory.q_eci_cam[i]), trajectory.q_eci_cam[j])
    return quaternion.log(turn) / (trajectory.t[j] - trajectory.t[i])


def apparent_velocity(trajectory: Trajectory, k: int) -> Vector3:
    """d(t_cam_target)/dt [m/s]: how the target's origin moves for the camera, the camera's own turn included."""
    v_rel_eci = trajectory.v_eci_target_mps[k] - trajectory.v_eci_chaser_mps[k]
    v_cam = quaternion.rotate(quaternion.conjugate(trajectory.q_eci_cam[k]), v_rel_eci)
    return v_cam - np.cross(camera_rate(trajectory, k), trajectory.T_cam_target(k).t_m)


def _sun(trajectory: Trajectory, k: int, q_target_eci: QuatWxyz) -> SunSpec:
    distance_au = sun_distance_m(trajectory.epoch_utc, float(trajectory.t[k])) / ASTRONOMICAL_UNIT
    return SunSpec(
        direction_target=triple(quaternion.rotate(q_target_eci, trajectory.sun_eci[k])),
        visible_fraction=float(trajectory.sun_visible[k]),
        irradiance=triple(np.array(SUN_IRRADIANCE) / distance_au**2),
    )


def _earth(trajectory: Trajectory, k: int, q_target_eci: QuatWxyz, config: SceneConfig) -> EarthSpec:
    turn = q_eci_ecef(trajectory.epoch_utc, trajectory.t[k : k + 1])[0]
    return EarthSpec(
        r_target_earth_m=triple(quaternion.rotate(q_target_eci, -trajectory.r_eci_target_m[k])),
        q_target_ecef=quadruple(quaternion.multiply(q_target_eci, turn)),
        cloud_cover=config.cloud_cover,
        cloud_seed=config.cloud_seed,
        atmosphere=config.atmosphere,
        city_lights=config.city_lights,
    )


def _exposure(trajectory: Trajectory, k: int, config: SceneConfig, seed: int) -> ExposureSpec:
    return ExposureSpec(
        exposure_s=config.exposure_s,
        temperature_c=config.temperature_c,
        v_cam_target_mps=triple(apparent_velocity(trajectory, k)),
        omega_cam_radps=triple(camera_rate(trajectory, k)),
        seed=seed,
    )


def _noise_seed(seed: int, index: int) -> int:
    return int(np.random.SeedSequence([seed, index]).generate_state(1)[0])
