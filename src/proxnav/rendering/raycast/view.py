"""One camera looking at one lit target: rays in, radiance and geometry out, in batches of fixed size."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int

from proxnav.datasets.records.scene import SUN_HALF_ANGLE
from proxnav.geometry import Camera, Pose
from proxnav.rendering.raycast import pixels as grid
from proxnav.rendering.raycast import shading
from proxnav.rendering.raycast.bsdf import lobe_albedo_table
from proxnav.rendering.raycast.lights import SUN_WIDENING, Lights
from proxnav.rendering.raycast.model import Model
from proxnav.rendering.raycast.rays import camera_numbers, cast
from proxnav.rendering.raycast.surface import COLUMNS, Hits, describe, locate
from proxnav.rendering.raycast.texels import TexelTable

BATCH = 32768
"""Rays at a time: small enough for the processor's cache, the same on every machine."""


@dataclass(frozen=True, slots=True, eq=False)
class Samples:
    """What n rays through the image saw; radiance is zero where they missed."""

    triangle: Int[np.ndarray, "n"]
    radiance: Float32[np.ndarray, "n 3"]
    position: Float[np.ndarray, "n 3"]
    depth: Float32[np.ndarray, "n"]
    """inf where the ray missed."""
    lit: Int[np.ndarray, "n"]
    """1 where the Sun's rays arrive, 0 where something blocks all or some, -1 where the surface turns away."""
    blocker: Float32[np.ndarray, "n"]
    """Distance to what blocks the Sun [m]."""


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """Camera, target and light of one frame."""

    model: Model
    textures: TexelTable
    lights: Lights
    camera: np.ndarray
    """As `rays.camera_numbers` gives it."""
    R_target_cam: Float[np.ndarray, "3 3"]
    eye: Float[np.ndarray, "3"]
    """The camera's projection centre in the target frame [m]."""
    reflections: bool

    @property
    def pixel_rad(self) -> float:
        """Angle that a pixel near the optical axis spans."""
        return float(1.0 / np.sqrt(self.camera[0] * self.camera[1]))


def look(
    model: Model, textures: TexelTable, lights: Lights, camera: Camera, T_cam_target: Pose, reflections: bool
) -> View:
    """The view of a camera."""
    T_target_cam = T_cam_target.inverse()
    return View(model, textures, lights, camera_numbers(camera), T_target_cam.R, T_target_cam.t_m, reflections)


def trace(
    view: View, pixels: Int[np.ndarray, "n 2"], places: Float[np.ndarray, "m 2"], per_pixel: int, sun_steps: int
) -> Samples:
    """Samples at points `places` [px], `per_pixel` for each pixel; `sun_steps` 0 aims at the centre of the Sun."""
    rays, origins, directions = _rays(view, places)
    triangle = view.model.tracer.first_hit(origins, directions)
    found = np.flatnonzero(triangle >= 0)
    hits = _hits(view, triangle[found], rays[found], view.pixel_rad / np.sqrt(per_pixel))
    lit, state, blocker = _sunlit(view, hits, pixels, found, per_pixel, sun_steps)
    return _scatter(len(places), triangle, found, hits, _shade(view, hits, lit), state, blocker)


def _rays(view: View, places: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    n = len(places)
    rays, origins, directions = np.empty((n, 3)), np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    mesh = view.model.mesh
    cast(places, view.camera, view.R_target_cam, view.eye, mesh.centre, mesh.radius, rays, origins, directions)
    return rays, origins, directions


def _hits(view: View, triangle: np.ndarray, rays: np.ndarray, pixel_rad: float) -> Hits:
    n, mesh, textures = len(triangle), view.model.mesh, view.textures
    hits = Hits(triangle, np.empty((n, 3)), np.empty(n), np.empty((n, 3)), np.empty((n, COLUMNS)))
    camera_z = np.ascontiguousarray(view.R_target_cam[:, 2])
    locate(triangle, rays, view.eye, camera_z, mesh.corners, hits.position, hits.depth, hits.weights)
    describe(
        triangle, hits.position, hits.depth, hits.weights, view.eye, pixel_rad, mesh.corners, mesh.normals,
        mesh.tangents, mesh.part, textures.texels, textures.levels, textures.parts, hits.surface,
    )  # fmt: skip
    return hits


def _sunlit(
    view: View, hits: Hits, pixels: np.ndarray, found: np.ndarray, per_pixel: int, steps: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """(share of the Sun's disc, state as in `Samples.lit`, distance to the blocker) of each hit."""
    n = len(hits.triangle)
    lit, state, blocker = np.zeros(n), np.full(n, -1, np.int8), np.zeros(n, np.float32)
    if not view.lights.has_sun:
        return lit, state, blocker
    which, origins, directions = np.empty(n, np.int64), np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    for step in range(max(1, steps)):
        sun = _sun_directions(view, pixels, found, per_pixel, step, steps)
        count = shading.sun_rays(hits.position, hits.surface, sun, which, origins, directions)
        index = which[:count]
        distance = view.model.tracer.distance(origins[:count], directions[:count])
        free = np.isinf(distance)
        lit[index] += free / max(1, steps)
        state[index] = free
        blocker[index] = np.where(free, 0.0, distance)
    return lit, state, blocker


def _sun_directions(
    view: View, pixels: np.ndarray, found: np.ndarray, per_pixel: int, step: int, steps: int
) -> np.ndarray:
    if steps == 0:
        return np.broadcast_to(view.lights.sun, (len(found), 3))
    directions = np.empty((len(pixels) * per_pixel, 3))
    grid.sun_points(pixels, per_pixel, step, steps, view.lights.sun, SUN_HALF_ANGLE, directions)
    return directions[found]


def _shade(view: View, hits: Hits, lit: np.ndarray) -> np.ndarray:
    """(n, 3) radiance of the hits."""
    mesh, lights = view.model.mesh, view.lights
    radiance = np.zeros((len(hits.triangle), 3))
    shading.shade_emission(hits.triangle, mesh.part, view.textures.parts, radiance)
    if lights.has_sun:
        shading.shade_sun(hits.surface, lights.sun, lit, lights.sun_irradiance, SUN_WIDENING, radiance)
    if lights.has_ambient:
        _shade_ambient(view, hits, radiance)
    return radiance


def _shade_ambient(view: View, hits: Hits, radiance: np.ndarray) -> None:
    mesh, lights, table = view.model.mesh, view.lights, lobe_albedo_table()
    usable = view.model.cache.usable
    if not view.reflections:
        hits.surface[:, 15] = 0.0
    shading.shade_ambient(
        hits.triangle, hits.weights, hits.surface, mesh.cache, usable, lights.indirect, table, radiance
    )
    n = len(hits.triangle)
    which, origins, directions = np.empty(n, np.int64), np.empty((n, 3), np.float32), np.empty((n, 3), np.float32)
    count = shading.mirror_rays(hits.position, hits.surface, which, origins, directions)
    seen = view.model.tracer.first_hit(origins[:count], directions[:count])
    shading.shade_mirror(
        which[:count], directions, seen, origins, mesh.corners, mesh.cache, usable, lights.exitance, hits.surface,
        lights.environment.radiance, lights.environment.lobes, table, radiance,
    )  # fmt: skip


def _scatter(
    n: int,
    triangle: np.ndarray,
    found: np.ndarray,
    hits: Hits,
    radiance: np.ndarray,
    state: np.ndarray,
    blocker: np.ndarray,
) -> Samples:
    """The hits' values at the places of their rays."""
    full = Samples(
        triangle, np.zeros((n, 3), np.float32), np.zeros((n, 3)), np.full(n, np.inf, np.float32),
        np.full(n, -1, np.int8), np.zeros(n, np.float32),
    )  # fmt: skip
    full.radiance[found], full.position[found], full.depth[found] = radiance, hits.position, hits.depth
    full.lit[found], full.blocker[found] = state, blocker
    return full
