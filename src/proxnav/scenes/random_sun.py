"""Where the Sun stands in a random scene, and how much of it the target sees."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from proxnav.errors import InputError
from proxnav.geometry.celestial import EARTH_EQUATORIAL_RADIUS, SUN_HALF_ANGLE, sun_visible_fraction
from proxnav.geometry.pointing import q_between
from proxnav.geometry.quaternion import rotate
from proxnav.geometry.types import Vector3
from proxnav.records import SunSpec
from proxnav.scenes.plain import triple

Light = Literal["sunlit", "penumbra", "umbra"]


@dataclass(frozen=True)
class SunConfig:
    """Directions are uniform within each kind of light."""

    umbra_share: float = 0.0
    penumbra_share: float = 0.0
    min_phase_rad: float = 0.0
    max_phase_rad: float = np.pi
    """Limits of the angle at the target between Sun and camera in sunlit frames: 0 is front light, pi back light."""
    lamp_share: float = 0.0
    """Share of the sunlit frames in which the disc is as large as a laboratory's lamp."""
    lamp_half_angle_rad: tuple[float, float] = (0.02, 0.5)
    """Limits of the angular radius of those discs, uniform in its logarithm."""

    def __post_init__(self) -> None:
        if min(self.umbra_share, self.penumbra_share) < 0.0 or self.umbra_share + self.penumbra_share > 1.0:
            raise InputError(
                f"umbra_share and penumbra_share are shares of all frames, found {self.umbra_share} and "
                f"{self.penumbra_share}; give numbers in [0, 1] that sum to 1 at most"
            )
        low, high = self.lamp_half_angle_rad
        if not 0.0 <= self.lamp_share <= 1.0 or not 0.0 < low <= high < np.pi / 2:
            raise InputError(
                f"lamp_share is a share of the frames and lamp_half_angle_rad two radii below a right angle, found "
                f"{self.lamp_share} and {self.lamp_half_angle_rad}"
            )


def draw_light(rng: np.random.Generator, config: SunConfig) -> Light:
    """The kind of light of one frame."""
    x = rng.random()
    if x < config.umbra_share:
        return "umbra"
    return "penumbra" if x < config.umbra_share + config.penumbra_share else "sunlit"


def draw_sun(rng: np.random.Generator, light: Light, nadir_target: Vector3, orbit_radius_m: float) -> SunSpec:
    """A Sun in target axes that gives this kind of light at this distance from Earth's centre."""
    limb = np.arcsin(EARTH_EQUATORIAL_RADIUS / orbit_radius_m)  # Earth's angular radius
    least, most = {
        "umbra": (0.0, limb - SUN_HALF_ANGLE),
        "penumbra": (limb - SUN_HALF_ANGLE, limb + SUN_HALF_ANGLE),
        "sunlit": (limb + SUN_HALF_ANGLE, np.pi),
    }[light]
    z = rng.uniform(np.cos(most), np.cos(least))  # uniform over the zone of the sphere
    around = rng.uniform(-np.pi, np.pi)
    about_nadir = np.array([np.sqrt(1.0 - z * z) * np.cos(around), np.sqrt(1.0 - z * z) * np.sin(around), z])
    direction = rotate(q_between(np.array([0.0, 0.0, 1.0]), nadir_target), about_nadir)
    fraction = sun_visible_fraction(-orbit_radius_m * nadir_target, direction)
    return SunSpec(direction_target=triple(direction), visible_fraction=float(fraction))


def with_lamp(rng: np.random.Generator, sun: SunSpec, config: SunConfig) -> SunSpec:
    """The same Sun, or a lamp in its place where the draw says so; nothing is drawn where no lamps are asked for."""
    if config.lamp_share == 0.0 or sun.visible_fraction < 1.0 or rng.random() >= config.lamp_share:
        return sun
    return replace(sun, half_angle_rad=float(np.exp(rng.uniform(*np.log(config.lamp_half_angle_rad)))))
