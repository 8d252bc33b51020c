"""The light of one frame: the Sun, Earth's map, and what both leave on the surfaces of the target."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32

from proxnav.records import SceneSpec
from proxnav.rendering.earth import environment_map
from proxnav.rendering.raycast.config import RaycastConfig
from proxnav.rendering.raycast.environment import Environment, build_environment
from proxnav.rendering.raycast.light_cache import OFFSET_M, gather
from proxnav.rendering.raycast.model import Model
from proxnav.rendering.raycast.texels import TexelTable

_NO_SKY = np.zeros((16, 32, 3), np.float32)


@dataclass(frozen=True, slots=True, eq=False)
class Lights:
    """Light on the target in one frame, in target axes."""

    sun: Float[np.ndarray, "3"]
    sun_irradiance: Float[np.ndarray, "3"]
    """W/m^2 at normal incidence, eclipse included."""
    sun_half_angle: float
    """Angular radius of the disc [rad]."""
    environment: Environment
    indirect: Float[np.ndarray, "n_cache 3"]
    """Irradiance of the light-cache points from Earth and from neighbouring surfaces."""
    sun_seen: Float[np.ndarray, "n_cache 3"]
    """1 where a light-cache point sees the Sun, else 0, for each band."""

    @property
    def sun_widening(self) -> float:
        """Added to alpha^2: half vectors to the points of the disc scatter by half_angle^2 / 16 along each axis."""
        return self.sun_half_angle**2 / 8.0

    @property
    def has_sun(self) -> bool:
        """Whether the Sun reaches the target at all."""
        return bool(self.sun_irradiance.any())

    @property
    def has_ambient(self) -> bool:
        """Whether anything but the Sun does."""
        return bool(self.indirect.any() or self.sun_seen.any())


def light_up(scene: SceneSpec, model: Model, textures: TexelTable, config: RaycastConfig) -> Lights:
    """The frame's light, gathered over the target's light cache."""
    sun = np.array(scene.sun.direction_target, dtype=np.float64)
    sun /= np.linalg.norm(sun)
    sun_irradiance = np.array(scene.sun.irradiance) * scene.sun.visible_fraction
    sky = None if scene.earth is None else environment_map(scene, config.environment_rows)
    environment = build_environment(_NO_SKY if sky is None else sky)
    follow = config.bounces > 0 and bool(sun_irradiance.any())
    seen = _sun_seen(model, sun) if follow else np.zeros(len(model.mesh.cache_part))
    cosine = seen * np.maximum(model.mesh.cache_normal @ sun, 0.0)
    indirect = _gathered(model, textures, cosine, sun_irradiance, sky, config)
    return Lights(
        sun, sun_irradiance, scene.sun.half_angle_rad, environment, indirect, np.repeat(seen[:, None], 3, axis=1)
    )


def _gathered(
    model: Model,
    textures: TexelTable,
    cosine: Float[np.ndarray, "n_cache"],
    sun_irradiance: Float[np.ndarray, "band=3"],
    sky: Float32[np.ndarray, "rows columns band=3"] | None,
    config: RaycastConfig,
) -> Float[np.ndarray, "n_cache band=3"]:
    """Indirect irradiance of the light cache [W/m^2], where the Sun shines with `cosine` (0 in shadow)."""
    albedo = textures.mean_albedo[model.mesh.cache_part].astype(np.float64)
    emitted = np.pi * textures.emission[model.mesh.cache_part]
    return gather(model.cache, albedo, emitted, cosine[:, None] * sun_irradiance, sky, config.bounces)


def _sun_seen(model: Model, sun: Float[np.ndarray, "3"]) -> Float[np.ndarray, "n_cache"]:
    """1 where a light-cache point sees the Sun, else 0."""
    mesh = model.mesh
    cosine = mesh.cache_normal @ sun
    facing = np.flatnonzero(cosine > 0.0)
    origins = mesh.cache_position[facing] + 10.0 * OFFSET_M * (mesh.cache_normal[facing] + sun)
    directions = np.broadcast_to(sun.astype(np.float32), origins.shape)
    shadowed = model.tracer.occluded(origins.astype(np.float32), np.ascontiguousarray(directions))
    light = np.zeros(len(cosine))
    light[facing] = np.where(shadowed, 0.0, model.cache.usable[facing])
    return light
