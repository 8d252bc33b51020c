"""Scenes drawn at random for training and test sets: a pure function of (seed, index).

The target flies at 400 km somewhere over Earth, LVLH-fixed (x ahead, z to nadir) up to a random departure; the camera
sees it from any side and at any range; the Sun stands where the configured share of lit and dark frames wants it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry import Camera, Pose, quaternion
from proxnav.geometry.celestial import EARTH_MEAN_RADIUS
from proxnav.geometry.pointing import phase_angle
from proxnav.geometry.types import QuatWxyz, Vector3
from proxnav.records import EarthSpec, ExposureSpec, SceneSpec, SensorSpec, SunSpec, TextureSpec
from proxnav.scenes.plain import quadruple, triple
from proxnav.scenes.random_sun import SunConfig, draw_light, draw_sun, with_lamp
from proxnav.scenes.random_view import ViewpointConfig, draw_view, sees_earth

DrawSensor = Callable[[np.random.Generator], SensorSpec]
AcceptView = Callable[[Pose], bool]
"""Whether a view T_cam_target is one that was asked for."""

_NADIR = np.array([0.0, 0.0, 1.0])  # in LVLH axes
_MAX_TRIES = 2000


@dataclass(frozen=True)
class RandomSceneConfig:
    """Ranges that frames are drawn from; pairs are (least, most) of a uniform distribution."""

    view: ViewpointConfig = field(default_factory=ViewpointConfig)
    sun: SunConfig = field(default_factory=SunConfig)
    altitude_m: float = 400e3
    """Above a sphere of Earth's mean radius."""
    attitude_sigma_rad: float = 0.02
    """Departure of the target from LVLH-fixed, per axis."""
    tumbling_share: float = 0.0
    """Share of frames in which the target's attitude is uniform on SO(3) instead."""
    earth: bool = True
    """False is a black sky without Earthshine."""
    earth_share: float | None = None
    """Share of frames with Earth in the picture; None leaves it to geometry (about half at 40 deg field of view)."""
    cloud_cover: tuple[float, float] = (0.2, 0.8)
    texture_strength: tuple[float, float] = (0.0, 1.0)
    exposure_s: float = 0.0
    """0 lets the sensor choose by its auto exposure."""
    temperature_c: tuple[float, float] = (0.0, 40.0)
    speed_sigma_mps: float = 0.02
    """Velocity of the target against the camera, per axis; the camera's own turn comes on top."""
    rate_sigma_radps: float = 1e-3
    """Inertial rate of the camera, per axis."""
    sensor: SensorSpec = field(default_factory=SensorSpec)
    """Used where no `draw_sensor` is handed in."""

    @property
    def orbit_radius_m(self) -> float:
        """Distance from Earth's centre."""
        return EARTH_MEAN_RADIUS + self.altitude_m


def random_scene(
    index: int,
    seed: int,
    config: RandomSceneConfig,
    target: str,
    camera: Camera,
    draw_sensor: DrawSensor | None = None,
    accept: AcceptView | None = None,
) -> SceneSpec:
    """Frame `index` of the set `seed`, drawn until `accept` takes its view.

    `draw_sensor` may vary the camera's image chain from frame to frame.
    """
    geometry, looks, sensing = np.random.default_rng([seed, index]).spawn(3)
    q_target_lvlh, T_cam_target, sun = _draw_geometry(geometry, config, camera, accept)
    sky = quaternion.random(geometry, 2)  # the place over Earth with its heading, and the stars
    return SceneSpec(
        index=index,
        target=target,
        camera=camera,
        q_cam_target=quadruple(T_cam_target.q_wxyz),
        t_cam_target_m=triple(T_cam_target.t_m),
        sun=with_lamp(geometry, sun, config.sun),
        earth=_draw_earth(looks, config, q_target_lvlh, sky[0]),
        q_target_eci=quadruple(sky[1]),
        texture=TextureSpec(strength=looks.uniform(*config.texture_strength), seed=_draw_seed(looks)),
        sensor=config.sensor if draw_sensor is None else draw_sensor(sensing),
        exposure=_draw_exposure(sensing, config, T_cam_target.t_m),
    )


def _draw_geometry(
    rng: np.random.Generator, config: RandomSceneConfig, camera: Camera, accept: AcceptView | None
) -> tuple[QuatWxyz, Pose, SunSpec]:
    """(q_target_lvlh, T_cam_target, Sun): drawn together until light, phase and background are the wanted ones."""
    light = draw_light(rng, config.sun)
    with_earth = None if config.earth_share is None else rng.random() < config.earth_share
    dip = np.arccos(EARTH_MEAN_RADIUS / config.orbit_radius_m)
    for _ in range(_MAX_TRIES):
        q_target_lvlh = _draw_attitude(rng, config)
        nadir = quaternion.rotate(q_target_lvlh, _NADIR)
        T_cam_target = draw_view(rng, config.view, camera, q_target_lvlh)
        sun = draw_sun(rng, light, nadir, config.orbit_radius_m)
        wrong_phase = light == "sunlit" and not _lit_as_asked(sun, T_cam_target, config.sun)
        wrong_sky = with_earth is not None and sees_earth(T_cam_target, nadir, camera, dip) != with_earth
        wrong_view = accept is not None and not accept(T_cam_target)
        if not (wrong_phase or wrong_sky or wrong_view):
            return q_target_lvlh, T_cam_target, sun
    raise InputError(
        f"no scene in {_MAX_TRIES} draws has a phase angle between {config.sun.min_phase_rad:.3g} and "
        f"{config.sun.max_phase_rad:.3g} rad, earth_share {config.earth_share} and the keypoints asked for in the "
        "picture: widen the phase angles or the ranges, or set earth_share to None"
    )


def _lit_as_asked(sun: SunSpec, T_cam_target: Pose, config: SunConfig) -> bool:
    phase_rad = phase_angle(np.array(sun.direction_target), T_cam_target.inverse().t_m)
    return bool(config.min_phase_rad <= phase_rad <= config.max_phase_rad)


def _draw_attitude(rng: np.random.Generator, config: RandomSceneConfig) -> QuatWxyz:
    """q_target_lvlh."""
    if rng.random() < config.tumbling_share:
        return quaternion.random(rng, 1)[0]
    return quaternion.exp(config.attitude_sigma_rad * rng.normal(size=3))


def _draw_earth(
    rng: np.random.Generator, config: RandomSceneConfig, q_target_lvlh: QuatWxyz, q_lvlh_ecef: QuatWxyz
) -> EarthSpec | None:
    cover, seed = rng.uniform(*config.cloud_cover), _draw_seed(rng)
    if not config.earth:
        return None
    r_target_earth: Vector3 = config.orbit_radius_m * quaternion.rotate(q_target_lvlh, _NADIR)
    return EarthSpec(
        r_target_earth_m=triple(r_target_earth),
        q_target_ecef=quadruple(quaternion.multiply(q_target_lvlh, q_lvlh_ecef)),
        cloud_cover=cover,
        cloud_seed=seed,
    )


def _draw_exposure(rng: np.random.Generator, config: RandomSceneConfig, t_cam_target_m: Vector3) -> ExposureSpec:
    omega = config.rate_sigma_radps * rng.normal(size=3)
    drift = config.speed_sigma_mps * rng.normal(size=3)
    return ExposureSpec(
        exposure_s=config.exposure_s,
        temperature_c=rng.uniform(*config.temperature_c),
        v_cam_target_mps=triple(drift - np.cross(omega, t_cam_target_m)),
        omega_cam_radps=triple(omega),
        seed=_draw_seed(rng),
    )


def _draw_seed(rng: np.random.Generator) -> int:
    return int(rng.integers(2**31))
